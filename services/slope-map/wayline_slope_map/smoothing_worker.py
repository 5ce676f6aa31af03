"""Has ended runs smoothed beside the messages, so that none waits for it."""

import logging
import queue
import threading
from collections.abc import Callable, Sequence
from typing import Protocol

import msgspec

from wayline.core import Record
from wayline.patient_store import PatientStore
from wayline_slope_map.left_out import LeftOut
from wayline_slope_map.records import DrivenRun, FinishedRun
from wayline_slope_map.smoothing_process import SmoothingProcess
from wayline_slope_map.store import SlopeTables

CAPACITY = 200
"""Runs that wait; a vehicle makes a few an hour, each takes a second or two."""
CLOSE_S, CLOSE_AWAY_S = 4.0, 1.5
"""What the end of the process waits for the last runs, and where the database is away, for which
the store then waits as well: supervisors kill after five seconds."""

log = logging.getLogger("wayline")


class Smoother(Protocol):
    """Smooths runs, one at a time."""

    def smoothed(self, driven: DrivenRun) -> Sequence[FinishedRun | LeftOut]:
        """What a run comes to; called in the worker's thread alone, and may take long."""
        ...

    def close(self) -> None:
        """Called once, at the end; a run that is being smoothed is given up."""
        ...


class SmoothingWorker:
    """A store of driven runs around one of finished runs: what is smoothed goes there."""

    def __init__(
        self,
        store: PatientStore[SlopeTables],
        capacity: int = CAPACITY,
        begin: Callable[[], Smoother] = SmoothingProcess,
    ) -> None:
        self._store, self._capacity, self._begin = store, capacity, begin
        self._waiting: queue.SimpleQueue[DrivenRun | None] = queue.SimpleQueue()
        self._lost = 0
        self._smoother: Smoother | None = None
        self._thread = threading.Thread(target=self._run, name="smoothing", daemon=True)
        self._failed: Callable[[], None] = lambda: None
        self._died = self._is_given_up = False

    def save(self, record: Record) -> Sequence[msgspec.Struct]:
        """Have a driven run smoothed and kept; whoever hands it over never waits.

        What was left out while it was driven is kept as it is.
        """
        if isinstance(record, LeftOut):
            self._store.put(record.vehicle_id, record)
            return ()
        if not isinstance(record, DrivenRun):
            raise TypeError(f"{type(record).__name__} is no driven run")
        if self._waiting.qsize() < self._capacity:
            self._waiting.put(record)
        else:
            self._lost += 1
        return ()

    def start(self, failed: Callable[[], None]) -> None:
        """Begin to work; `failed` is called, in another thread, if it cannot go on."""
        self._failed = failed
        self._store.start(failed)
        self._smoother = self._begin()
        self._thread.start()

    def hand_over(self) -> None:
        """Tell, in the caller's thread, what the tables have said."""
        self._store.hand_over()

    def close(self) -> None:
        """Smooth and keep what waits, as far as that is quick. Raises what ended a thread."""
        try:
            self._end()
        finally:
            self._store.close()

    def _end(self) -> None:
        self._waiting.put(None)
        if self._smoother is None:
            return
        self._thread.join(CLOSE_S if self._store.problem is None else CLOSE_AWAY_S)
        self._is_given_up = self._thread.is_alive()
        self._smoother.close()
        if self._is_given_up:
            log.warning("runs could not be smoothed in time and are lost")
        elif self._died:
            raise RuntimeError("the smoothing of a run died, its traceback is above")

    @property
    def problem(self) -> str | None:
        """Why nothing is kept now; None where all is well."""
        return self._store.problem

    @property
    def detail(self) -> str | None:
        """What `health` should say: the database's problem, and runs that were lost here."""
        lost = f"runs lost: {self._lost}, too many waited to be smoothed" if self._lost else None
        return "; ".join(each for each in (self._store.detail, lost) if each) or None

    def _run(self) -> None:
        self._died = True
        try:
            while (driven := self._waiting.get()) is not None:
                self._keep(driven)
            self._died = False
        finally:
            if self._died and not self._is_given_up:
                self._failed()

    def _keep(self, driven: DrivenRun) -> None:
        if self._smoother is None:
            raise RuntimeError("a worker that has not been started")
        for each in self._smoother.smoothed(driven):
            self._store.put(each.vehicle_id, each)
