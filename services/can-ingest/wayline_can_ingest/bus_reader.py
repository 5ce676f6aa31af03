"""Reads one opened bus in a thread that may die or hang without harm to the rest."""

import struct
import threading
import time
from collections import Counter
from collections.abc import Callable
from typing import Any

import can
import msgspec

from wayline.inputs import Frame
from wayline.live_sources import LiveCan
from wayline_can_ingest.frames import BUS_OFF, FrameReader
from wayline_can_ingest.obd2_poll import Obd2Poll
from wayline_can_ingest.wanted import Wanted

READ_S = 0.2
SILENT_S = 5.0
"""A bus on which nothing is heard for so long is opened anew: its adapter may have restarted."""
ERROR_S = 0.5
"""A bus that is silent for so long after an error is opened anew: a socket whose interface is gone
raises once and is deaf for ever."""
SEND_S = 0.1
BUS_OFF_S = 1.0
"""A bus is opened anew so long after a bus-off, which most adapters leave only in this way."""
LOOK_S = 2.0
"""Without a mapped frame for so long the filters are taken off, to tell what the bus carries."""
MOST_ERRORS = 10
"""A damaged frame makes one error; a device that is gone makes one at every call."""
DRIVER_ERRORS = (
    can.CanError,
    OSError,
    ArithmeticError,
    AttributeError,
    LookupError,
    RuntimeError,
    TypeError,
    ValueError,
    struct.error,
)
"""What python-can's drivers raise on bad frames and lost devices. Of anything else the thread
dies, its traceback is printed and the bus opened anew."""
READ_ERRORS = "read errors"
SEND_ERRORS = "send errors"
FILTERING = frozenset(("etas", "kvaser", "socketcan", "systec", "vector"))
"""Interfaces whose kernel or adapter filters (python-can 4.6); elsewhere python-can's own filter
would cost more than looking a frame up."""

NOT_TRIED = "not tried yet"

OpenBus = Callable[[LiveCan], can.BusABC]
Put = Callable[[msgspec.Struct], None]


def open_bus(source: LiveCan) -> can.BusABC:
    """The bus as configured. Raises CanError, OSError, and what a driver else raises."""
    options: dict[str, Any] = dict(source.options)
    if source.bitrate is not None:
        options["bitrate"] = source.bitrate
    return can.Bus(interface=source.interface, channel=source.channel, **options)


class Ear:
    """What was heard on a bus, over all the times it was opened."""

    def __init__(
        self,
        channel: str,
        wanted: Wanted,
        *,
        interface: str,
        now_ns: Callable[[], int] = time.time_ns,
    ) -> None:
        self._reader = FrameReader(channel)
        self._now_ns = now_ns
        self._wanted = wanted
        self.filters = wanted.filters if interface in FILTERING else None
        self.faults: Counter[str] = self._reader.faults
        self.trouble: str | None = NOT_TRIED
        """Why nothing can be heard; None once the bus is open or a frame has come."""
        self.openings = 0
        self.frame_s: float | None = None
        self.mapped_s: float | None = None

    @property
    def state(self) -> str | None:
        """What the controller said of itself last, None since a frame came."""
        return self._reader.state

    def take(self, message: object, put: Put, poll: Obd2Poll | None) -> None:
        """Give a frame on if it is mapped, or what it answers to the polling."""
        frame: Frame | None = self._reader.frame(message, self._now_ns())
        if frame is None:
            return
        self.frame_s, self.trouble = time.monotonic(), None
        if poll is not None and poll.is_reply(frame):
            frame = poll.hear(frame, self.frame_s)
        if frame is not None and self._wanted.has(frame):
            self.mapped_s = self.frame_s
            put(frame)


class BusReader(threading.Thread):
    """A bus from its opening to its end."""

    def __init__(
        self, open_it: Callable[[], can.BusABC], ear: Ear, put: Put, poll: Obd2Poll | None
    ) -> None:
        # a driver that hangs must not keep the process from ending
        super().__init__(name="bus", daemon=True)
        self._open_it, self._ear, self._put, self._poll = open_it, ear, put, poll
        self._left = threading.Event()
        self._turned_s = self._opened_s = time.monotonic()
        self._patience_s = SILENT_S
        self._filtered = False
        self.is_open = False
        self.has_ended = False
        """In order, be it by an error; a thread that dies of something else has not."""

    @property
    def note(self) -> str | None:
        """How the polling does."""
        return None if self._poll is None else self._poll.note

    @property
    def stands_s(self) -> float:
        """How long it has not turned."""
        return time.monotonic() - self._turned_s

    def leave(self) -> None:
        """Take no more from it; it ends as soon as its driver lets it."""
        self._left.set()

    def run(self) -> None:
        """Open and read until left, deaf or in error."""
        try:
            with self._open_it() as bus:
                self._turned_s = self._opened_s = time.monotonic()
                self.is_open = True
                if not self._left.is_set():
                    self._ear.trouble = None
                    self._ear.openings += 1
                self._read(bus)
        except (*DRIVER_ERRORS, ImportError) as error:
            self._note_trouble(error)
        self.has_ended = True

    def _note_trouble(self, error: Exception) -> None:
        if not self._left.is_set():
            self._ear.trouble = " ".join(str(error).split()) or type(error).__name__

    def _read(self, bus: can.BusABC) -> None:
        errors = 0
        while not self._left.is_set():
            self._turned_s = now_s = time.monotonic()
            self._aim(bus, now_s)
            wait_s = READ_S if self._poll is None else self._ask(bus, self._poll, now_s)
            try:
                message = bus.recv(wait_s)
            except DRIVER_ERRORS as error:
                errors += 1
                self._count(READ_ERRORS, error)
                if errors == MOST_ERRORS:
                    raise
            else:
                errors = 0
                if message is not None and not self._left.is_set():
                    self._ear.take(message, self._put, self._poll)
            if self._is_deaf():
                return

    def _ask(self, bus: can.BusABC, poll: Obd2Poll, now_s: float) -> float:
        """Send what is due; how long to wait for the reply."""
        for message in poll.act(now_s):
            try:
                bus.send(message, SEND_S)
            except DRIVER_ERRORS as error:
                self._count(SEND_ERRORS, error)
        return min(poll.wait_s(now_s), READ_S)

    def _count(self, reason: str, error: Exception) -> None:
        self._ear.faults[reason] += 1
        self._note_trouble(error)
        self._patience_s = ERROR_S

    def _is_deaf(self) -> bool:
        """Whether nothing has come for longer than can be explained."""
        heard_s = max(self._ear.frame_s or 0.0, self._opened_s)
        if self._ear.trouble is None:
            self._patience_s = BUS_OFF_S if self._ear.state == BUS_OFF else SILENT_S
        return self._turned_s - heard_s > self._patience_s

    def _aim(self, bus: can.BusABC, now_s: float) -> None:
        """Filter while mapped frames come."""
        mapped_s = self._ear.mapped_s
        is_fed = mapped_s is not None and now_s - mapped_s < LOOK_S
        filtered = self._ear.filters is not None and is_fed
        if filtered != self._filtered:
            bus.set_filters(self._ear.filters if filtered else None)
            self._filtered = filtered
