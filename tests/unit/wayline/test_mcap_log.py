"""Files of the bus: every message comes back, other tools read them, broken ones are named."""

from pathlib import Path
from typing import Any

import jsonschema_rs
import msgspec
import pytest
from mcap.reader import make_reader
from mcap.records import Channel, Schema
from mcap.writer import Writer

from builders import START_NS, at, fix, gyro
from wayline.codec import encode
from wayline.errors import InputError
from wayline.keys import message_key
from wayline.mcap_log import McapWriter, is_finished, read_messages, read_records
from wayline.mcap_schema import message_schema
from wayline.messages import (
    MESSAGES,
    TOPICS,
    AidedSatellite,
    Aiding,
    Arrivals,
    Barometer,
    FusionStatus,
    GpsRaw,
    GpsSky,
    Health,
    Horizon,
    HorizonPoint,
    Message,
    Odometer,
    Pose,
    Progress,
    RawSatellite,
    Satellite,
    StopArrival,
    StopEvent,
    Torque,
    Trip,
    TripStop,
    Verdict,
)

EVERY: tuple[Message, ...] = (
    fix(0.0, 55.0, 10.0, h_std_m=2.5),
    GpsSky(t_ns=at(0.1), satellites=(Satellite(system="gps", prn=7, used=True),)),
    GpsRaw(t_ns=at(0.1), satellites=(RawSatellite(system="gps", prn=7, pseudorange_m=2.1e7),)),
    Odometer(t_ns=at(0.2), speed_mps=3.5, reverse=False),
    gyro(0.3, -1.25),
    Torque(t_ns=at(0.4), engine_torque_nm=-20.0, gear=-1),
    Barometer(t_ns=at(0.5), pressure_pa=101_325.0),
    Pose(t_ns=at(0.6), mode="fused", lat_deg=55.0, lon_deg=10.0, heading_deg=359.5),
    FusionStatus(
        t_ns=at(0.7),
        verdicts=(Verdict(sensor="gps", t_ns=at(0.7), accepted=False, nis=20.0, threshold=9.2),),
    ),
    Aiding(
        t_ns=at(0.7),
        satellites=(AidedSatellite(system="gps", prn=7, doppler_hz=-900.0, doppler_std_hz=1.0),),
    ),
    Progress(
        t_ns=at(0.8), route_id="Rødby/7", distance_m=12.0, lat_deg=55.0, lon_deg=10.0,
        cross_track_m=-1.0, distance_std_m=2.0, on_route=True, speed_mps=3.5,
    ),
    Arrivals(
        t_ns=at(0.9), route_id="7", stale=False,
        stops=(StopArrival(stop_id="a", name="Å", distance_m=1.0, arrival_ns=at(9),
                           early_ns=at(8), late_ns=at(10)),),
    ),
    StopEvent(
        t_ns=at(0.9), route_id="7", stop_id="a", stop_sequence=3, kind="skipped", distance_m=1.0,
    ),
    Horizon(t_ns=at(1.0), points=(HorizonPoint(distance_m=20.0, grade_pct=-3.0, runs=2),)),
    Trip(
        t_ns=at(1.0),
        trip_key="bus-7_20231114T221320Z",
        started_ns=at(0.0),
        ended_ns=at(1.0),
        distance_m=12.0,
        distance_std_m=0.5,
        moving_s=1.0,
        max_speed_mps=12.0,
        stops=(TripStop(started_ns=at(0.5), dwell_s=10.0, lat_deg=1.0, lon_deg=2.0),),
    ),
    Health(t_ns=at(1.1), service="fusion", version="0", started_ns=START_NS),
)  # fmt: skip


def written(path: Path, messages: tuple[Message, ...] = EVERY) -> Path:
    """A closed recording of one vehicle."""
    with McapWriter(path) as writer:
        for message in messages:
            writer.write("bus-7", "test", message, message.t_ns + 5_000_000)
    return path


def cut(path: Path, keep: float) -> Path:
    """The first part of a file, as a killed writer would leave it."""
    content = path.read_bytes()
    path.write_bytes(content[: int(len(content) * keep)])
    return path


def test_the_examples_are_of_every_topic() -> None:
    assert {type(message) for message in EVERY} == set(MESSAGES)


def test_every_message_comes_back(tmp_path: Path) -> None:
    path = written(tmp_path / "a.mcap")
    assert list(read_messages(path)) == [("bus-7", "test", message) for message in EVERY]
    assert is_finished(path)


def test_records_keep_key_payload_and_arrival(tmp_path: Path) -> None:
    key = message_key("bus-7", "gyro", "can-ingest")
    payload = b'{"t_ns":5,"yaw_rate_degps":1.0,"from_the_future":true}'
    with McapWriter(tmp_path / "a.mcap") as writer:
        writer.write_payload(key, "gyro", payload, 5, 17)
    assert list(read_records(tmp_path / "a.mcap")) == [(17, key, payload)]


def test_the_mcap_package_reads_it_with_its_index(tmp_path: Path) -> None:
    with written(tmp_path / "a.mcap").open("rb") as file:
        reader = make_reader(file, validate_crcs=True)
        summary = reader.get_summary()
        found = [(channel, record) for _, channel, record in reader.iter_messages()]
    assert summary is not None
    assert summary.statistics is not None
    assert summary.statistics.message_count == len(EVERY)
    assert [channel.topic for channel, _ in found] == [
        message_key("bus-7", message.topic, "test") for message in EVERY
    ]
    assert {channel.message_encoding for channel, _ in found} == {"json"}
    assert [record.publish_time for _, record in found] == [message.t_ns for message in EVERY]
    assert {record.log_time - record.publish_time for _, record in found} == {5_000_000}
    assert [record.data for _, record in found] == [encode(message) for message in EVERY]
    assert {index.compression for index in summary.chunk_indexes} == {"zstd"}


def test_sequences_count_each_channel(tmp_path: Path) -> None:
    messages = (gyro(0, 1), fix(0.1, 55, 10), gyro(0.2, 1), gyro(0.3, 1))
    with written(tmp_path / "a.mcap", messages).open("rb") as file:
        found = [record.sequence for _, _, record in make_reader(file).iter_messages()]
    assert found == [0, 0, 1, 2]


def test_each_topic_has_one_schema_that_its_messages_obey(tmp_path: Path) -> None:
    seen: set[str] = set()
    with written(tmp_path / "a.mcap").open("rb") as file:
        for schema, _, record in make_reader(file).iter_messages():
            assert schema is not None
            assert schema.encoding == "jsonschema"
            document = msgspec.json.decode(schema.data)
            jsonschema_rs.Draft7Validator(document).validate(msgspec.json.decode(record.data))
            seen.add(schema.name)
    assert seen == {f"wayline.{message.__name__}" for message in MESSAGES}


@pytest.mark.parametrize(
    ("topic", "payload"),
    [
        ("gyro", {"yaw_rate_degps": 1.0}),
        ("gyro", {"t_ns": 5, "yaw_rate_degps": "fast"}),
        ("gps_fix", {"t_ns": 5, "valid": True, "lat_deg": 91.0}),
        ("arrivals", {"t_ns": 5, "route_id": "7", "stale": False, "stops": [{"stop_id": "a"}]}),
    ],
)
def test_a_payload_that_breaks_its_schema_is_refused(topic: str, payload: Any) -> None:
    validator = jsonschema_rs.Draft7Validator(message_schema(TOPICS[topic]))
    assert not validator.is_valid(payload)


def assert_plain(schema: dict[str, Any]) -> None:
    """What Foxglove asks of a schema: one type each, an object's fields and a list's items."""
    assert schema["type"] in {"object", "array", "string", "integer", "number", "boolean"}
    for field in schema.get("properties", {}).values():
        assert "$ref" not in field
        assert_plain(field)
    if schema["type"] == "array":
        assert_plain(schema["items"])


@pytest.mark.parametrize("message", MESSAGES)
def test_schemas_have_the_plain_shape_that_viewers_read(message: type[Message]) -> None:
    schema = message_schema(message)
    assert schema["type"] == "object"
    assert list(schema["properties"]) == list(message.__struct_fields__)
    assert_plain(schema)


def test_a_writer_killed_after_a_second_leaves_what_it_had(tmp_path: Path) -> None:
    path = tmp_path / "a.mcap"
    with McapWriter(path) as writer:
        for tenth in range(25):
            writer.write("bus-7", "test", gyro(tenth / 10, tenth), at(tenth / 10))
        left = path.read_bytes()
    (tmp_path / "left.mcap").write_bytes(left)
    found = [message for _, _, message in read_messages(tmp_path / "left.mcap")]
    assert found == [gyro(tenth / 10, tenth) for tenth in range(21)]
    assert not is_finished(tmp_path / "left.mcap")
    assert len(list(read_records(path))) == 25


@pytest.mark.parametrize("keep", [0.2, 0.4, 0.6])
def test_a_file_cut_anywhere_gives_its_first_messages(tmp_path: Path, keep: float) -> None:
    messages = tuple(gyro(second, second) for second in range(100))
    path = cut(written(tmp_path / "a.mcap", messages), keep)
    found = [message for _, _, message in read_messages(path)]
    assert found == list(messages[: len(found)])
    assert 100 * keep / 2 < len(found) < 100


def test_a_step_back_of_the_clock_does_not_hold_messages_back(tmp_path: Path) -> None:
    path = tmp_path / "a.mcap"
    with McapWriter(path) as writer:
        writer.write("bus-7", "test", gyro(0, 1), at(1000))
        writer.write("bus-7", "test", gyro(1, 2), at(0))
        (tmp_path / "left.mcap").write_bytes(path.read_bytes())
    assert [log_time_ns for log_time_ns, _, _ in read_records(tmp_path / "left.mcap")] == [
        at(1000),
        at(0),
    ]


@pytest.mark.parametrize("position", [47, 49, 200])
def test_a_damaged_file_is_named(tmp_path: Path, position: int) -> None:
    # of the first chunk: its length (too long for the file, for any memory), its content
    path = written(tmp_path / "a.mcap")
    content = bytearray(path.read_bytes())
    content[position] ^= 0x41
    path.write_bytes(content)
    with pytest.raises(InputError, match=r"a\.mcap: is damaged before byte .*another copy"):
        list(read_records(path))


@pytest.mark.parametrize("content", [b"", b"\x89MCAP", b"t_s,lat_deg,lon_deg\n1,2,3\n"])
def test_another_kind_of_file_is_named(tmp_path: Path, content: bytes) -> None:
    (tmp_path / "a.mcap").write_bytes(content)
    with pytest.raises(InputError, match="is no MCAP file"):
        list(read_records(tmp_path / "a.mcap"))


def test_a_missing_file_is_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no such file"):
        list(read_records(tmp_path / "a.mcap"))


def test_a_file_in_a_missing_folder_cannot_be_made(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="cannot be made"):
        McapWriter(tmp_path / "none" / "a.mcap")


def foreign(path: Path, channels: dict[str, str]) -> Path:
    """A recording by someone else: one message on each topic, of an encoding."""
    writer = Writer(str(path))
    writer.start()
    for topic, encoding in channels.items():
        channel = writer.register_channel(topic=topic, message_encoding=encoding, schema_id=0)
        writer.add_message(channel_id=channel, log_time=1, data=b"{}", publish_time=1)
    writer.finish()  # type: ignore[no-untyped-call]  # mcap has not typed it
    return path


def test_a_recording_of_something_else_is_named(tmp_path: Path) -> None:
    path = foreign(tmp_path / "a.mcap", {"/imu": "cdr", message_key("a", "gyro", "b"): "cdr"})
    with pytest.raises(InputError, match="holds no Wayline messages"):
        list(read_records(path))


def test_channels_of_others_are_left_out(tmp_path: Path) -> None:
    key = message_key("a", "gyro", "b")
    path = foreign(tmp_path / "a.mcap", {"/imu": "json", key: "json"})
    assert list(read_records(path)) == [(1, key, b"{}")]


def test_a_payload_that_does_not_fit_is_told_and_left_out(tmp_path: Path) -> None:
    key = message_key("a", "gyro", "b")
    refused: list[str] = []
    path = foreign(tmp_path / "a.mcap", {key: "json"})
    assert list(read_messages(path, refused=refused.append)) == []
    assert refused == [key]


def test_an_empty_recording_is_no_error(tmp_path: Path) -> None:
    assert list(read_records(written(tmp_path / "a.mcap", ()))) == []


def test_channels_of_a_file_point_at_their_schemas(tmp_path: Path) -> None:
    with written(tmp_path / "a.mcap").open("rb") as file:
        summary = make_reader(file).get_summary()
    assert summary is not None
    schemas: dict[int, Schema] = summary.schemas
    channels: list[Channel] = list(summary.channels.values())
    assert {schemas[channel.schema_id].name for channel in channels} == {
        f"wayline.{message.__name__}" for message in MESSAGES
    }
