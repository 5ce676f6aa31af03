"""Smooths ended runs in a thread of its own, so that no message waits for it."""

import logging
import queue
import threading
from collections.abc import Callable, Sequence

import msgspec

from wayline.core import Record
from wayline.patient_store import PatientStore
from wayline_slope_map.records import DrivenRun
from wayline_slope_map.run import smoothed_runs
from wayline_slope_map.store import SlopeTables

CAPACITY = 200
"""Runs that wait; a vehicle makes a few an hour, each takes a second or two."""
CLOSE_S = 4.0
"""What the end of the process waits for the last runs; supervisors kill after five seconds."""

log = logging.getLogger("wayline")


class SmoothingWorker:
    """A store of driven runs around one of finished runs: what is smoothed goes there."""

    def __init__(self, store: PatientStore[SlopeTables], capacity: int = CAPACITY) -> None:
        self._store, self._capacity = store, capacity
        self._waiting: queue.SimpleQueue[DrivenRun | None] = queue.SimpleQueue()
        self._lost = 0
        self._thread = threading.Thread(target=self._run, name="smoothing", daemon=True)
        self._failed: Callable[[], None] = lambda: None
        self._died = False

    def save(self, record: Record) -> Sequence[msgspec.Struct]:
        """Have a driven run smoothed and kept; whoever hands it over never waits."""
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
        if self._thread.is_alive():
            self._thread.join(CLOSE_S)
        if self._thread.is_alive():
            log.warning("runs could not be smoothed in time and are lost")
            return
        if self._died:
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
                for run in smoothed_runs(driven):
                    self._store.put(run.vehicle_id, run)
            self._died = False
        finally:
            if self._died:
                self._failed()
