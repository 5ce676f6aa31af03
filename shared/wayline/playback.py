"""Plays a drive's recordings paced as it was driven, as a feed of an ingest service."""

import threading
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager

import msgspec

from wayline.messages import Message
from wayline.play_clock import LEAD_S, PlayClock
from wayline.received import Received, Recording, Sources

PAUSE_NS = 1_000_000_000
"""Between the end of a loop and the next one's start."""


class PlayOptions(msgspec.Struct, frozen=True, kw_only=True):
    """How to play."""

    speed: float = 1.0
    loop: bool = False
    now: bool = False
    """Shift every t_ns by one constant, so that the drive starts now."""


class Played(msgspec.Struct, frozen=True):
    """A message that needs no core any more."""

    source: str
    message: Message


Agree = Callable[[PlayClock], AbstractContextManager[PlayClock]]
"""From the own clock to the one shared with the other players, who may ask for it meanwhile."""


class Playback:
    """The recordings of one service, opened anew for each loop."""

    can_wait = True

    def __init__(
        self,
        name: str,
        open_recordings: Callable[[], Sequence[Recording]],
        options: PlayOptions,
        agree: Agree,
    ) -> None:
        self.name = name
        self._open_recordings = open_recordings
        self._options = options
        self._agree = agree
        self._loops = 0
        self._played = 0
        self._bad_input = 0
        self._playing: Sequence[Recording] = ()
        self._is_over = False

    @property
    def detail(self) -> str | None:
        """How far it has come."""
        if self._is_over:
            return f"played to its end, {self._played} messages"
        if not self._played:
            return "about to play"
        return f"playing, loop {self._loops + 1}" if self._options.loop else "playing"

    @property
    def problem(self) -> str | None:
        """That nothing more comes, once it has played."""
        return "played to its end" if self._is_over else None

    @property
    def bad_input(self) -> int:
        """What was counted and dropped so far, over all loops."""
        return self._bad_input + sum(recording.bad_input() for recording in self._playing)

    def run(self, put: Callable[[msgspec.Struct], None], stop: threading.Event) -> None:
        """Put each message when it is due; returns at the end, or never with `loop`."""
        own = self._own_clock(stop)
        # without a message of its own it has no clock to bring, and nothing to wait for
        if own is not None:
            with self._agree(own) as clock:
                self._play(clock, put, stop)
        self._is_over = not stop.is_set()

    def _play(
        self, clock: PlayClock, put: Callable[[msgspec.Struct], None], stop: threading.Event
    ) -> None:
        shift_ns = clock.start_ns - clock.origin_ns if self._options.now else 0
        while not stop.is_set():
            offset_ns = self._loops * clock.period_ns
            for received in self._received():
                self._wait_until_due(clock, received.received_ns + offset_ns, stop)
                if stop.is_set():
                    return
                put(shifted(received, shift_ns + offset_ns))
                self._played += 1
            if not self._options.loop:
                return
            self._loops += 1

    def _received(self) -> Iterator[Received]:
        self._bad_input = self.bad_input
        self._playing = self._open_recordings()
        return iter(Sources(self._playing))

    def _own_clock(self, stop: threading.Event) -> PlayClock | None:
        """Where the own recordings begin, and, to loop, how long they last; None if empty."""
        messages = self._received()
        first = last = next(messages, None)
        while self._options.loop and not stop.is_set() and (later := next(messages, None)):
            last = later
        self._bad_input, self._playing = 0, ()
        if first is None or last is None:
            return None
        return PlayClock(
            origin_ns=first.received_ns,
            start_ns=time.time_ns() + round(LEAD_S * 1e9),
            period_ns=last.received_ns - first.received_ns + PAUSE_NS,
        )

    def _wait_until_due(self, clock: PlayClock, received_ns: int, stop: threading.Event) -> None:
        due_ns = clock.start_ns + round((received_ns - clock.origin_ns) / self._options.speed)
        wait_s = (due_ns - time.time_ns()) * 1e-9
        if wait_s > 0.0:
            stop.wait(wait_s)


def shifted(received: Received, shift_ns: int) -> Played:
    """A received message under its own source, moved in time."""
    message = received.message
    if shift_ns:
        message = msgspec.structs.replace(message, t_ns=message.t_ns + shift_ns)
    return Played(received.source, message)
