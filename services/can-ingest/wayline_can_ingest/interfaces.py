"""Live CAN interfaces as feeds. Each comes back by itself, however its bus or adapter went."""

import threading
import time
from collections import Counter
from collections.abc import Callable, Mapping

import msgspec

from wayline.live_sources import LiveCan
from wayline_can_ingest.bus_condition import BusCondition
from wayline_can_ingest.bus_reader import BusReader, Ear, OpenBus, open_bus
from wayline_can_ingest.obd2_poll import Obd2Poll
from wayline_can_ingest.wanted import Wanted

RETRY_S = (0.1, 0.2, 0.5)
"""Between attempts to open. The last goes on: frames come within 2 s of a return."""
WATCH_S = 0.05
READING_S = 1.0
"""A reader that does not turn for so long hangs in its driver; it waits 0.2 s for a frame."""
OPENING_S = 10.0
"""Serial adapters take seconds to open; a driver that takes longer hangs."""
MOST_HANGING = 4
"""Threads left in a driver that hangs. A further one would hang as well."""


class Interface:
    """One bus as a feed of frames.

    The driver is called in a thread of its own, which may die of whatever it raises and hang
    wherever it hangs: it is left behind and the bus opened anew. `now_ns` tells Unix time.
    """

    can_wait = False

    def __init__(
        self,
        name: str,
        source: LiveCan,
        wanted: Wanted,
        *,
        polls: bool = False,
        open_it: OpenBus = open_bus,
        now_ns: Callable[[], int] = time.time_ns,
    ) -> None:
        self.name = name
        self._source, self._polls, self._open_it = source, polls, open_it
        self._ear = Ear(str(source.channel), wanted, interface=source.interface, now_ns=now_ns)
        self._reader: BusReader | None = None
        self._hanging: list[BusReader] = []
        self._own_faults: Counter[str] = Counter()

    @property
    def condition(self) -> BusCondition:
        """How the interface does now."""
        reader, ear = self._reader, self._ear
        now_s = time.monotonic()

        def age_s(then_s: float | None) -> float | None:
            return None if then_s is None else max(now_s - then_s, 0.0)

        return BusCondition(
            name=f"{self._source.interface} {self._source.channel}",
            link_error=ear.trouble,
            state=ear.state,
            note=None if reader is None else reader.note,
            frame_age_s=age_s(ear.frame_s),
            mapped_age_s=age_s(ear.mapped_s),
            reconnections=max(ear.openings - 1, 0),
            faults=self.faults,
        )

    @property
    def faults(self) -> Mapping[str, int]:
        """What was counted and left out, by reason."""
        return self._ear.faults + self._own_faults

    @property
    def detail(self) -> str:
        """How the interface does, for `health`."""
        return self.condition.text

    @property
    def problem(self) -> str | None:
        """Why no mapped frame comes; None where some do."""
        condition = self.condition
        return None if condition.problem is None else f"{condition.name}: {condition.problem}"

    def run(self, put: Callable[[msgspec.Struct], None], stop: threading.Event) -> None:
        """Read until told to stop; open anew whenever the reader ends, dies, hangs or is deaf."""
        failures = 0
        while not stop.is_set():
            if self._has_room():
                heard_s = self._ear.frame_s
                self._read(put, stop)
                if self._ear.frame_s != heard_s:
                    failures = 0
            stop.wait(RETRY_S[min(failures, len(RETRY_S) - 1)])
            failures += 1

    def _has_room(self) -> bool:
        self._hanging = [reader for reader in self._hanging if reader.is_alive()]
        return len(self._hanging) < MOST_HANGING

    def _read(self, put: Callable[[msgspec.Struct], None], stop: threading.Event) -> None:
        poll = Obd2Poll() if self._polls else None
        reader = BusReader(lambda: self._open_it(self._source), self._ear, put, poll)
        self._reader = reader
        reader.start()
        self._watch(reader, stop)
        reader.leave()
        if stop.is_set():
            reader.join(READING_S)

    def _watch(self, reader: BusReader, stop: threading.Event) -> None:
        """Until the reader has ended or hangs."""
        while reader.is_alive() and not stop.is_set():
            reader.join(WATCH_S)
            if reader.stands_s > (READING_S if reader.is_open else OPENING_S):
                self._fail("hangs", "the driver hangs")
                self._hanging.append(reader)
                return
        if not stop.is_set() and not reader.has_ended:
            self._fail("deaths", "the reader died")

    def _fail(self, reason: str, trouble: str) -> None:
        self._own_faults[reason] += 1
        self._ear.trouble = trouble
