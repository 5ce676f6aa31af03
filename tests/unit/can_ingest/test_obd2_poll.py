"""A car is asked for what it supports, as often as it copes, and for nothing else."""

import threading
from collections.abc import Iterator

import msgspec
import pytest

from builders import only
from buses import WAIT_S, await_true
from ecu import SUPPORTED, Ecu
from wayline.drive import Vehicle
from wayline.inputs import Frame
from wayline.live_sources import LiveCan
from wayline.messages import Barometer, Message, Odometer, Torque
from wayline_can_ingest.configured import load_mapping
from wayline_can_ingest.core import CanIngestCore
from wayline_can_ingest.interfaces import Interface
from wayline_can_ingest.obd2_poll import (
    FUNCTIONAL_EXTENDED_ID,
    FUNCTIONAL_ID,
    PENDING_S,
    REPLY_S,
    Obd2Poll,
    supported_pids,
)
from wayline_can_ingest.wanted import Wanted

CAR = Vehicle(profile="obd2")


def reply(text: str, identifier: int = 0x7E8) -> Frame:
    """A frame of a control unit."""
    return Frame(1, "x", identifier, identifier > 0x7FF, bytes.fromhex(text).ljust(8, b"\0"))


def met(now_s: float = 0.0) -> Obd2Poll:
    """A poll whose call was answered by a unit with engine speed and speed alone."""
    poll = Obd2Poll()
    poll.act(now_s)
    assert poll.hear(reply("064100 00180000"), now_s) is None
    return poll


def asked(poll: Obd2Poll, now_s: float) -> list[str]:
    """Requests sent, without their padding."""
    return [bytes(each.data[: 1 + each.data[0]]).hex() for each in poll.act(now_s)]


def test_a_silent_vehicle_is_called_by_short_and_long_identifiers_in_turn() -> None:
    """Twice a second, which is little on any bus."""
    poll = Obd2Poll()
    times_s = [number * 0.1 for number in range(20)]
    called = [each.arbitration_id for now_s in times_s for each in poll.act(now_s)]
    assert called == [FUNCTIONAL_ID, FUNCTIONAL_EXTENDED_ID] * 2
    assert poll.note == "the vehicle does not answer"


def test_only_what_is_supported_is_asked_for() -> None:
    """Bits of the reply to 00: here 0C and 0D."""
    assert supported_pids(bytes.fromhex("410000180001")) == {0x0C, 0x0D, 0x20}
    poll = met()
    requests = []
    for number in range(200):
        now_s = number * 0.01
        for request in asked(poll, now_s):
            requests.append(request)
            poll.hear(reply(f"0441{request[4:6]}1122"), now_s)
    assert set(requests) == {"02010c", "02010d"}
    assert 60 < len(requests) < 90  # two values at 20 Hz for 2 s


def test_a_unit_that_answers_slowly_is_asked_again_only_when_it_has_answered() -> None:
    """One request is under way at a time."""
    poll = met()
    assert len(asked(poll, 0.0)) == 1
    assert asked(poll, REPLY_S / 2) == []


def test_a_refused_value_is_left_alone_and_the_others_go_on() -> None:
    """Response code 12h: not supported."""
    poll = met()
    (first,) = asked(poll, 0.0)
    poll.hear(reply("037f0112"), 0.01)
    later = [request for number in range(100) for request in _answered(poll, 0.1 + number * 0.05)]
    assert first not in later
    assert len(later) > 50


def _answered(poll: Obd2Poll, now_s: float) -> list[str]:
    requests = asked(poll, now_s)
    for request in requests:
        poll.hear(reply(f"0441{request[4:6]}1122"), now_s)
    return requests


def test_a_reply_that_is_announced_is_waited_for() -> None:
    """Response code 78h: pending."""
    poll = met()
    asked(poll, 0.0)
    poll.hear(reply("037f0178"), 0.01)
    assert asked(poll, PENDING_S - 0.1) == []


def test_a_vehicle_that_falls_silent_is_called_anew() -> None:
    """After some requests in vain."""
    poll = met()
    times_s = [number * 0.1 for number in range(60)]
    calls = [each.arbitration_id for now_s in times_s for each in poll.act(now_s)]
    assert 0x7E0 in calls
    assert FUNCTIONAL_ID in calls
    assert poll.note == "the vehicle does not answer"


def test_rubbish_from_a_control_unit_is_ignored() -> None:
    """Empty frames, other services, a first frame that never goes on."""
    poll = met()
    for text in ("", "00", "01", "0141", "0241", "064902010203", "1014490201", "ffffffffff"):
        assert poll.hear(reply(text), 0.0) is None
    assert asked(poll, 0.0)


class Car:
    """A control unit, an interface that asks it, and what comes of it."""

    def __init__(self, channel: str, *, extended: bool) -> None:
        source = LiveCan(interface="virtual", channel=channel)
        mapping = load_mapping(source, CAR, "test")
        core = CanIngestCore(source, mapping, CAR)
        self.messages: list[Message] = []
        self.ecu = Ecu(channel, extended=extended)
        self.bus = Interface("can-ingest", source, Wanted(mapping), polls=True)
        self._stop = threading.Event()

        def put(given: msgspec.Struct) -> None:
            self.messages.extend(core.handle(given, "can-ingest"))

        self._thread = threading.Thread(target=self.bus.run, args=(put, self._stop), daemon=True)
        self._thread.start()

    def close(self) -> None:
        """End both."""
        self._stop.set()
        self._thread.join(WAIT_S)
        self.ecu.close()


@pytest.fixture(params=[False, True], ids=["11 bits", "29 bits"])
def car(request: pytest.FixtureRequest) -> Iterator[Car]:
    one = Car(f"obd2-{request.param}", extended=request.param)
    yield one
    one.close()


def test_a_car_gives_speed_torque_and_pressure(car: Car) -> None:
    """Through the profile, as a recording of the same replies would."""

    def has_all() -> bool:
        torques = only(car.messages, Torque)
        return bool(
            only(car.messages, Odometer)
            and only(car.messages, Barometer)
            and any(torque.engine_torque_nm is not None for torque in torques)
            and any(torque.engine_speed_rpm is not None for torque in torques)
        )

    await_true(has_all, "every quantity")
    assert only(car.messages, Odometer)[0].speed_mps == pytest.approx(25.0)
    assert only(car.messages, Barometer)[0].pressure_pa == 98_000.0
    torques = only(car.messages, Torque)
    known = [each.engine_torque_nm for each in torques if each.engine_torque_nm is not None]
    assert known == [pytest.approx(120.0)] * len(known)
    assert {each.engine_speed_rpm for each in torques} <= {None, 2000.0}
    assert "polls" in car.bus.detail


def test_nothing_but_values_is_asked_for(car: Car) -> None:
    """Service 01, and only what the unit supports."""
    await_true(lambda: len(car.ecu.asked) > 30, "requests")
    assert {request[0] for request in car.ecu.asked} == {1}
    assert {request[1] for request in car.ecu.asked} <= SUPPORTED | {0}


def test_a_car_that_is_switched_off_and_on_is_heard_again(car: Car) -> None:
    """Health says so meanwhile."""
    await_true(lambda: bool(car.messages), "a message")
    car.ecu.speaks = False
    await_true(lambda: "does not answer" in car.bus.detail, "it is noticed")
    car.ecu.speaks = True
    count = len(car.messages)
    await_true(lambda: len(car.messages) > count, "a further message")
