"""Keys, codec, grid and the one loop that replay and live share."""

from collections.abc import Sequence
from typing import ClassVar

import msgspec
import pytest

from builders import at, fix, gyro
from wayline.codec import decode, encode
from wayline.core import Record
from wayline.grid import LONGEST_GAP_NS, TickGrid
from wayline.inputs import Flush, Tick
from wayline.keys import Key, alive_key, is_vehicle_id, message_key, parse_key
from wayline.messages import MESSAGES, TOPICS, GpsFix, Gyro, Message, Odometer, stale_after_s
from wayline.node import Node
from wayline.pipeline import Pipeline

TENTH_NS = 100_000_000
SATELLITES = ['{"system":"gps","prn":1}'] * 2_001


def test_every_message_survives_the_codec() -> None:
    fixed = fix(1.5, 55.0, 10.0, alt_m=12.0, h_std_m=2.5)
    assert decode("gps_fix", encode(fixed)) == fixed


def test_unknown_is_null_on_the_wire() -> None:
    assert b'"alt_m":null' in encode(fix(0, 55.0, 10.0))


def test_unknown_fields_are_ignored_and_new_ones_have_defaults() -> None:
    payload = b'{"t_ns":%d,"yaw_rate_degps":1.0,"from_the_future":true}' % at(0)
    assert decode("gyro", payload) == Gyro(t_ns=at(0), yaw_rate_degps=1.0)


@pytest.mark.parametrize(
    ("topic", "payload"),
    [
        ("gyro", "{"),
        ("gyro", '{"yaw_rate_degps":1.0}'),
        ("gyro", '{"t_ns":315532799999999999}'),
        ("gyro", '{"t_ns":4102444800000000001}'),
        ("gps_fix", '{"t_ns":NOW,"valid":true,"lat_deg":91.0}'),
        ("gps_fix", '{"t_ns":NOW,"valid":true,"course_deg":360.0}'),
        ("gps_fix", '{"t_ns":NOW,"valid":true,"h_std_m":0.0}'),
        ("gps_fix", '{"t_ns":NOW,"valid":true,"speed_mps":200.1}'),
        ("odometer", '{"t_ns":NOW,"speed_mps":-1.0}'),
        ("odometer", '{"t_ns":NOW,"speed_mps":200.1}'),
        ("pose", '{"t_ns":NOW,"mode":"flying"}'),
        ("pose", '{"t_ns":NOW,"mode":"gps","speed_mps":-200.1}'),
        ("pose", '{"t_ns":NOW,"mode":"gps","east_std_m":1.1e7}'),
        ("pose", '{"t_ns":NOW,"mode":"gps","of_no_use":"' + "x" * 524_288 + '"}'),
        ("arrivals", '{"t_ns":NOW,"stale":false,"route_id":"' + "x" * 257 + '"}'),
        ("gps_sky", '{"t_ns":NOW,"satellites":[' + ",".join(SATELLITES) + "]}"),
    ],
)
def test_a_payload_out_of_bounds_is_refused(topic: str, payload: str) -> None:
    with pytest.raises(msgspec.DecodeError):
        decode(topic, payload.replace("NOW", f"{at(0)}").encode())


def test_a_payload_within_its_bounds_is_read() -> None:
    widest = '{"t_ns":NOW,"mode":"gps","speed_mps":-200.0,"east_std_m":1e7}'
    assert decode("pose", widest.replace("NOW", f"{at(0)}").encode()).t_ns == at(0)
    most = '{"t_ns":NOW,"satellites":[' + ",".join(SATELLITES[1:]) + "]}"
    assert decode("gps_sky", most.replace("NOW", f"{at(0)}").encode()).t_ns == at(0)


def test_keys_are_read_back() -> None:
    key = message_key("bus-7", "pose", "fusion")
    assert key == "wayline/v1/bus-7/pose/fusion"
    assert parse_key(key) == Key("bus-7", "pose", "fusion")


@pytest.mark.parametrize(
    "key",
    [
        "wayline/@v2/bus-7/pose/fusion",
        "wayline/v1/Bus/pose/fusion",
        "wayline/v1/bus-7/unknown/fusion",
        "wayline/v1/bus-7/pose",
        alive_key("bus-7", "fusion"),
    ],
)
def test_other_keys_are_none_of_ours(key: str) -> None:
    assert parse_key(key) is None


@pytest.mark.parametrize(
    ("text", "good"),
    [("bus-7", True), ("7", True), ("a" * 64, True), ("a" * 65, False), ("", False),
     ("-a", False), ("a b", False), ("bus\n", False)],
)  # fmt: skip
def test_vehicle_ids(text: str, good: bool) -> None:
    assert is_vehicle_id(text) is good


def test_every_topic_goes_stale_after_three_messages_or_two_seconds() -> None:
    assert {stale_after_s(message) for message in MESSAGES} == {2.0, 3.0, 60.0, 300.0}
    assert stale_after_s(TOPICS["pose"]) == 2.0
    assert stale_after_s(TOPICS["stop_event"]) == 60.0, "one every 20 s"


def test_the_grid_gives_each_instant_once_before_the_message_that_passes_it() -> None:
    grid = TickGrid(TENTH_NS)
    times = [at(0.05), at(0.17), at(0.18), at(0.4)]
    before = [[tick.t_ns for tick in grid.before(t_ns)] for t_ns in times]
    assert before == [[], [at(0.1)], [], [at(0.2), at(0.3)]]
    assert [tick.t_ns for tick in grid.at(at(0.4))] == [at(0.4)]
    assert list(grid.before(at(0.45))) == []


def test_late_messages_bring_no_ticks() -> None:
    grid = TickGrid(TENTH_NS)
    assert list(grid.before(at(1.05))) == []
    assert list(grid.before(at(0.2))) == []
    assert list(grid.before(at(1.15))) == [Tick(at(1.1))]


def test_a_long_silence_is_skipped() -> None:
    grid = TickGrid(TENTH_NS)
    list(grid.before(at(0.0)))
    after_ns = at(0.0) + LONGEST_GAP_NS + 10 * TENTH_NS
    assert list(grid.before(after_ns)) == []
    assert list(grid.at(after_ns)) == [Tick(after_ns)]


class Kept(Record, frozen=True, kw_only=True):
    """A record of the echo core."""

    t_ns: int


class Learned(msgspec.Struct, frozen=True):
    """The echo store's answer."""

    t_ns: int


class Echo:
    """Publishes an odometer for each gyro and tick, keeps a record a fix, tells when it learned."""

    reads: ClassVar[frozenset[type[Message]]] = frozenset({Gyro, GpsFix})
    period_ns: ClassVar[int | None] = TENTH_NS

    def handle(self, message: msgspec.Struct, source: str) -> Sequence[Message | Record]:
        del source
        match message:
            case Gyro():
                return [Odometer(t_ns=message.t_ns, speed_mps=1.0)]
            case Tick():
                return [Odometer(t_ns=message.t_ns, speed_mps=2.0)]
            case GpsFix():
                return [Kept(t_ns=message.t_ns)]
            case Learned():
                return [Odometer(t_ns=message.t_ns, speed_mps=3.0)]
            case Flush():
                return [Odometer(t_ns=message.t_ns, speed_mps=4.0)]
        return []


class EchoStore:
    """Answers each record once."""

    def save(self, record: Record) -> Sequence[msgspec.Struct]:
        assert isinstance(record, Kept)
        return [Learned(record.t_ns)]


def test_ticks_come_before_a_later_message_and_after_one_at_their_instant() -> None:
    node = Node("echo", Echo())
    speeds = [
        [message.speed_mps for message in node.take(each, "gyro") if isinstance(message, Odometer)]
        for each in (gyro(0.05, 0), gyro(0.1, 0), gyro(0.25, 0))
    ]
    assert speeds == [[1.0], [1.0, 2.0], [2.0, 1.0]]


def test_what_a_store_answers_reaches_the_core() -> None:
    published: list[Message] = []
    pipeline = Pipeline([Node("echo", Echo(), EchoStore())], lambda m, _: published.append(m))
    pipeline.feed(fix(0.05, 55.0, 10.0), "gps-ingest")
    pipeline.finish()
    assert published == [
        fix(0.05, 55.0, 10.0),
        Odometer(t_ns=at(0.05), speed_mps=3.0),
        Odometer(t_ns=at(0.05), speed_mps=4.0),
    ]
