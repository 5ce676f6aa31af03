"""An interface on python-can's virtual bus, whose driver, frames and senders break."""

import logging
import threading
from collections.abc import Iterator

import can
import msgspec
import pytest

from buses import BACK_S, WAIT_S, DriverBugError, await_true, back_within, message
from wayline.live_sources import LiveCan
from wayline_can_ingest.bus_reader import READ_ERRORS, open_bus
from wayline_can_ingest.frames import ERROR, MALFORMED, REMOTE
from wayline_can_ingest.interfaces import Interface
from wayline_can_ingest.wanted import Everything

log = logging.getLogger(__name__)

CHANNEL = "virtual-faults"
SOURCE = LiveCan(interface="virtual", channel=CHANNEL)
FLOOD = 20_000
BAD_FRAMES = {
    ERROR: message(0x20, bytes(8), is_error_frame=True),
    REMOTE: message(0x20, b"", is_remote_frame=True),
    MALFORMED: message(0x4000_0000, is_extended_id=True),
}


class Live:
    """The interface at work, and a sender that speaks every 10 ms while it `speaks`."""

    def __init__(self) -> None:
        self.opened: list[can.BusABC] = []
        self.frames = 0
        self.speaks = True
        self.interface = Interface("can-ingest", SOURCE, Everything(), open_it=self._open)
        self.sender = can.Bus(interface="virtual", channel=CHANNEL)
        self._stop = threading.Event()
        self._threads = [
            threading.Thread(target=self.interface.run, args=(self._put, self._stop), daemon=True),
            threading.Thread(target=self._speak, daemon=True),
        ]
        for thread in self._threads:
            thread.start()

    def _open(self, source: LiveCan) -> can.BusABC:
        self.opened.append(open_bus(source))
        return self.opened[-1]

    def _put(self, frame: msgspec.Struct) -> None:
        self.frames += 1

    def _speak(self) -> None:
        while not self._stop.wait(0.01):
            if self.speaks:
                self.sender.send(message())

    @property
    def was_held_up(self) -> bool:
        """Whether this machine was so busy that the reader was left behind, with what it had."""
        return "hangs" in self.interface.faults

    def back_s(self) -> float:
        """From now until a further frame."""
        before = self.frames
        return await_true(lambda: self.frames > before, "a frame")

    def close(self) -> None:
        """End it."""
        self._stop.set()
        for thread in self._threads:
            thread.join(WAIT_S)
        self.sender.shutdown()


@pytest.fixture
def live() -> Iterator[Live]:
    one = Live()
    one.back_s()
    yield one
    one.close()


def test_an_interface_that_is_closed_under_its_reader_is_opened_anew(live: Live) -> None:
    """As when an adapter is pulled out, or `ip link set down`; counted."""

    def close() -> None:
        before = live.interface.faults.get(READ_ERRORS, 0)
        live.opened[-1].shutdown()
        await_true(lambda: live.interface.faults.get(READ_ERRORS, 0) > before, "is counted")

    back_within(BACK_S, "virtual: closed", close, live.back_s)
    assert live.interface.condition.reconnections >= 1


@pytest.mark.filterwarnings("ignore::pytest.PytestUnhandledThreadExceptionWarning")
def test_a_reader_that_dies_is_followed_by_another(
    live: Live, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of an exception that no driver should raise."""

    def die() -> None:
        before = live.interface.faults.get("deaths", 0)

        def recv(timeout: float | None = None) -> can.Message:
            raise DriverBugError

        monkeypatch.setattr(live.opened[-1], "recv", recv)
        await_true(lambda: live.interface.faults.get("deaths", 0) > before, "is counted")

    back_within(BACK_S, "virtual: reader died", die, live.back_s)


def test_bad_frames_are_counted_and_hold_up_nothing(live: Live) -> None:
    """A hundred error frames, remote frames and impossible identifiers each."""
    wanted = dict.fromkeys(BAD_FRAMES, 0)

    def send() -> None:
        for kind, frame in BAD_FRAMES.items():
            wanted[kind] += 100
            for _ in range(100):
                live.sender.send(frame)

    back_within(BACK_S, "virtual: bad frames", send, live.back_s)
    await_true(lambda: live.was_held_up or dict(live.interface.faults) == wanted, "each is counted")


def test_a_flood_is_read_to_its_end(live: Live) -> None:
    """Frames as fast as they can be sent; none is lost."""
    sent = 0

    def flood() -> None:
        nonlocal sent
        for _ in range(FLOOD):
            live.sender.send(message())
        sent += FLOOD
        read_s = await_true(lambda: live.was_held_up or live.frames >= sent, "the whole flood")
        log.info("flood: %d frames read %.2f s after they were sent", live.frames, read_s)

    back_within(BACK_S, "virtual: flood", flood, live.back_s)


def test_a_bus_that_was_silent_is_heard_when_it_speaks(live: Live) -> None:
    """Also after the interface was opened anew in vain."""

    def pause() -> None:
        openings = len(live.opened)
        live.speaks = False
        await_true(lambda: len(live.opened) > openings, "is opened anew")
        live.speaks = True

    back_within(BACK_S, "virtual: pause", pause, live.back_s)
