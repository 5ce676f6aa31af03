"""The fleet's view shared between the thread that hears the bus and the threads that serve it."""

import threading
import time
from collections.abc import Callable

from wayline.messages import Message
from wayline.query_error import QueryError
from wayline.view import Clock, Receipt
from wayline_dashboard.fleet import Cursor, Fleet
from wayline_dashboard.instant import Instant
from wayline_dashboard.view import FleetView
from wayline_dashboard.view_model import SHOWN


class LiveView:
    """A `Fleet` behind a lock, which is held for microseconds: nothing is encoded under it.

    Ages follow `monotonic_ns`, the clock of receipts; `wall_ns` is the time that pages are told.
    """

    def __init__(
        self,
        monotonic_ns: Clock = time.monotonic_ns,
        wall_ns: Callable[[], int] = time.time_ns,
    ) -> None:
        self._monotonic_ns, self._wall_ns = monotonic_ns, wall_ns
        self._lock = threading.Lock()
        self._fleet = Fleet()
        self._inputs = 0

    @property
    def reads(self) -> frozenset[type[Message]]:
        """Topics of the bus that it wants."""
        return SHOWN

    @property
    def inputs(self) -> int:
        """How many messages and events have come in."""
        return self._inputs

    def put(self, vehicle_id: str, message: Message, source: str, receipt: Receipt) -> None:
        """Take a bus message of a vehicle (or of `_fleet`)."""
        with self._lock:
            self._inputs += 1
            self._fleet.put(vehicle_id, message, source, receipt)

    def put_service(self, vehicle_id: str, service: str, up: bool) -> None:
        """Take a liveliness event of a vehicle's (or of `_fleet`'s) service."""
        with self._lock:
            self._inputs += 1
            self._fleet.put_service(vehicle_id, service, up)

    def forget(self, vehicle_id: str) -> None:
        """Drop what is known of a vehicle and tell the pages; it comes back when heard again."""
        with self._lock:
            self._fleet.forget(vehicle_id)

    def snapshot(self, selected: str | None = None) -> FleetView:
        """Everything known now; horizon and trail of the selected vehicle only.

        Raises QueryError (404) where the selected vehicle is not known.
        """
        with self._lock:
            if selected is not None and not self._fleet.knows(selected):
                raise QueryError(404, f"no vehicle {selected} was heard; /v1/view lists them")
            return self._fleet.snapshot(selected, self._now())

    def read(self, cursor: Cursor) -> FleetView | None:
        """What is new to a reader since its last call; moves its cursor on."""
        with self._lock:
            return self._fleet.read(cursor, self._now())

    def heartbeat(self, cursor: Cursor) -> FleetView:
        """A change that holds nothing, so that a page knows the line from a silent vehicle."""
        return FleetView(
            kind="changes",
            now=self._now().text,
            selected=cursor.selected,
            vehicles=(),
            gone=(),
            services=None,
        )

    def _now(self) -> Instant:
        return Instant(self._wall_ns(), self._monotonic_ns())
