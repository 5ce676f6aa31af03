"""A bus whose adapter raises, vanishes, hangs and talks rubbish is read again by itself."""

import errno
import math
import threading
import time
from collections.abc import Callable, Iterator
from typing import Any

import can
import msgspec
import pytest
from cantools.database.can import Message as DbcMessage

from buses import WAIT_S, Adapter, await_true, message
from wayline.inputs import Frame
from wayline.live_sources import LiveCan
from wayline_can_ingest.interfaces import Interface
from wayline_can_ingest.mapping import FrameKey, Mapping
from wayline_can_ingest.plan import FramePlan
from wayline_can_ingest.wanted import Wanted

PLAN = FramePlan(DbcMessage(0x100, "Any", 8, [], is_extended_frame=False), j1939=False)
WANTED = Wanted(Mapping({FrameKey(0x100, False): (PLAN,)}))


class Running:
    """An interface at work on an adapter."""

    def __init__(self, adapter: Adapter, interface: str = "fake") -> None:
        self.adapter = adapter
        self.frames: list[Frame] = []
        self._stop = threading.Event()
        source = LiveCan(interface=interface, channel="x")
        self.bus = Interface("can-ingest", source, WANTED, open_it=adapter.open)
        self._thread = threading.Thread(
            target=self.bus.run, args=(self._put, self._stop), daemon=True
        )
        self._thread.start()

    def _put(self, given: msgspec.Struct) -> None:
        assert isinstance(given, Frame)
        self.frames.append(given)

    def await_frame(self) -> float:
        """Seconds until a further frame comes."""
        count = len(self.frames)
        return await_true(lambda: len(self.frames) > count, "a frame")

    def await_text(self, text: str) -> None:
        """Until health says something."""
        await_true(lambda: text in self.bus.detail, f"{text} in {self.bus.detail}")

    def stop(self) -> None:
        """End it, within the time that a hanging driver may cost."""
        self._stop.set()
        self._thread.join(WAIT_S)
        assert not self._thread.is_alive()


@pytest.fixture
def running() -> Iterator[Running]:
    adapter = Adapter()
    one = Running(adapter)
    one.await_frame()
    yield one
    adapter.hang.set()
    one.stop()
    await_true(lambda: all(bus.is_shut for bus in adapter.opened), "every bus is closed")


def after(said: can.Message | None) -> can.Message | None:
    """What a read gives after 10 ms."""
    time.sleep(0.01)
    return said


def raising(error: Exception) -> Callable[[float | None], Any]:
    """A read that raises."""

    def recv(timeout: float | None) -> Any:
        raise error

    return recv


def test_frames_come_with_their_bytes_and_the_time_of_the_bus(running: Running) -> None:
    """As the adapter stamped them."""
    frame = running.frames[-1]
    assert (frame.arbitration_id, frame.extended, frame.data) == (0x100, False, b"\x01\x02")
    assert abs(frame.t_ns - time.time_ns()) < 10**9 * WAIT_S
    assert running.bus.condition.problem is None
    assert "fake x: well, last frame 0." in running.bus.detail


@pytest.mark.parametrize(
    "error",
    [
        can.CanOperationError("Failed to receive", errno.ENETDOWN),
        OSError(errno.ENODEV, "No such device"),
        AttributeError("'NoneType' object has no attribute 'in_waiting'"),
        ValueError("invalid literal"),
    ],
    ids=lambda error: type(error).__name__,
)
def test_an_adapter_that_vanishes_and_comes_back_is_read_again(
    running: Running, error: Exception
) -> None:
    """While it is gone health says why; it is counted, and opened anew once it is back."""
    running.adapter.open_error = error
    running.adapter.recv = raising(error)
    running.await_text("not open")
    assert str(error) in running.bus.detail
    running.adapter.open_error = None
    running.adapter.recv = running.adapter.speak
    running.await_frame()
    running.await_text("well")
    assert running.bus.condition.reconnections >= 1
    assert running.bus.faults["read errors"] == 10


def test_a_driver_that_hangs_is_left_behind(running: Running) -> None:
    """A second opening goes on, and the first gives nothing more when it wakes."""
    adapter = running.adapter
    adapter.hang.clear()

    def hang_once(timeout: float | None) -> Any:
        adapter.recv = adapter.speak
        adapter.hang.wait()
        return message(data=b"late")

    adapter.recv = hang_once
    await_true(lambda: running.bus.faults["hangs"] == 1, "a hang is counted")
    running.await_frame()
    adapter.hang.set()
    await_true(lambda: adapter.opened[0].is_shut, "the one left behind has ended")
    running.await_frame()
    assert b"late" not in {frame.data for frame in running.frames}


def test_a_service_ends_though_its_driver_hangs() -> None:
    """Nothing waits for a driver for long."""
    adapter = Adapter()
    adapter.hang.clear()

    def hang(timeout: float | None) -> Any:
        adapter.hang.wait()

    adapter.recv = hang
    one = Running(adapter)
    await_true(lambda: bool(adapter.opened), "it was opened")
    one.stop()
    adapter.hang.set()
    await_true(lambda: adapter.opened[0].is_shut, "it ends when it can")


class DriverBugError(Exception):
    """What nobody expects."""


@pytest.mark.filterwarnings("ignore::pytest.PytestUnhandledThreadExceptionWarning")
def test_a_reader_that_dies_of_anything_is_replaced(running: Running) -> None:
    """python-can's own Notifier would stay dead (its issue 1828)."""
    adapter = running.adapter

    def die_once(timeout: float | None) -> Any:
        adapter.recv = adapter.speak
        raise DriverBugError

    adapter.recv = die_once
    await_true(lambda: running.bus.faults["deaths"] == 1, "a death is counted")
    running.await_frame()


@pytest.mark.parametrize(
    ("bad", "reason"),
    [
        (message(is_error_frame=True), "error frames"),
        (message(data=b"", is_remote_frame=True), "remote frames"),
        (message(identifier=1 << 30, is_extended_id=True), "malformed"),
        ("rubbish", "malformed"),
        (7, "malformed"),
    ],
)
def test_one_bad_frame_is_counted_and_the_next_one_read(
    running: Running, bad: object, reason: str
) -> None:
    """The bus stays open."""
    adapter = running.adapter

    def be_bad_once(timeout: float | None) -> Any:
        adapter.recv = adapter.speak
        return bad

    adapter.recv = be_bad_once
    await_true(lambda: running.bus.faults[reason] == 1, f"{reason} are counted")
    running.await_frame()
    assert len(adapter.opened) == 1


def test_a_read_that_fails_now_and_then_closes_nothing(running: Running) -> None:
    """A datagram that is no frame makes python-can raise; the next one is good."""
    adapter = running.adapter
    turns = iter(range(10_000))

    def stumble(timeout: float | None) -> Any:
        if next(turns) % 3 == 0:
            raise can.CanOperationError("could not unpack received message")
        return adapter.speak(timeout)

    adapter.recv = stumble
    await_true(lambda: running.bus.faults["read errors"] > 20, "many errors")
    assert len(adapter.opened) == 1


@pytest.mark.parametrize("stamp_s", [0.0, 1e6, math.nan, -5.0])
def test_stamps_of_a_clock_from_elsewhere_become_unix_time(
    running: Running, stamp_s: float
) -> None:
    """Adapters count from their start, or not at all."""
    adapter = running.adapter
    began_ns = time.time_ns()
    adapter.recv = lambda timeout: after(message(timestamp=stamp_s + time.monotonic(), data=b"odd"))
    await_true(lambda: any(frame.data == b"odd" for frame in running.frames), "an odd frame")
    assert began_ns - 10**9 * WAIT_S < running.frames[-1].t_ns <= time.time_ns()


def test_error_frames_tell_of_bus_off(running: Running) -> None:
    """And the interface is opened anew meanwhile, which most adapters need."""
    adapter = running.adapter
    off = message(identifier=0x40, data=bytes(8), is_error_frame=True)
    said = iter([off])
    adapter.recv = lambda timeout: after(next(said, None))
    running.await_text("bus-off")
    await_true(lambda: len(adapter.opened) > 2, "opened again and again")
    adapter.recv = adapter.speak
    running.await_text("well")


def test_frames_that_nothing_maps_are_not_given_on(running: Running) -> None:
    """Health tells a bus that says something else from one that is silent."""
    running.adapter.recv = lambda timeout: after(message(identifier=0x7FF))
    running.await_text("no mapped frame")
    running.adapter.recv = lambda timeout: after(None)
    running.await_text("silent")


def test_an_adapter_filters_while_mapped_frames_come() -> None:
    """And lets everything through when they stay away, to tell what is there."""
    adapter = Adapter()
    one = Running(adapter, interface="socketcan")
    expected = [{"can_id": 0x100, "can_mask": 0x7FF, "extended": False}]
    await_true(lambda: bool(adapter.opened), "it is open")
    await_true(lambda: adapter.opened[0].filters_set[1:] == [expected], "filters are set")
    adapter.recv = lambda timeout: after(None)
    await_true(lambda: adapter.opened[0].filters_set[1:] == [expected, None], "and taken off")
    one.stop()
