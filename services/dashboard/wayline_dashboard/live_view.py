"""The fleet's view shared between the thread that hears the bus and the threads that serve it."""

import threading
import time
from collections.abc import Callable

import msgspec

from wayline.rfc3339 import rfc3339
from wayline.view import Receipt
from wayline_dashboard.core import DashboardCore, ServiceEvent
from wayline_dashboard.fleet import Cursor, Fleet
from wayline_dashboard.view import FleetView


class LiveView:
    """A `Fleet` behind a lock. `clock_ns` is the wall clock that pages measure ages with.

    The lock is held for microseconds: no message is encoded or sent under it.
    """

    def __init__(self, clock_ns: Callable[[], int] = time.time_ns) -> None:
        self._clock_ns = clock_ns
        self._lock = threading.Lock()
        self._fleet = Fleet()
        self._inputs = 0

    @property
    def inputs(self) -> int:
        """How many messages and events have come in."""
        return self._inputs

    reads = DashboardCore.reads

    def forget(self, vehicle_id: str) -> None:
        """Drop what is known of a vehicle."""

    def put(
        self, vehicle_id: str, message: msgspec.Struct, source: str, receipt: Receipt | None = None
    ) -> None:
        """Take a bus message of a vehicle (or of `_fleet`)."""
        del receipt
        with self._lock:
            self._inputs += 1
            self._fleet.handle(vehicle_id, message, source, self._clock_ns())

    def put_service(self, vehicle_id: str, service: str, up: bool) -> None:
        """Take a liveliness event of a vehicle's (or of `_fleet`'s) service."""
        self.put(vehicle_id, ServiceEvent(service, up), service)

    def snapshot(self) -> FleetView:
        """Everything known now."""
        with self._lock:
            return self._fleet.snapshot(self._clock_ns())

    def read(self, cursor: Cursor) -> FleetView | None:
        """What is new to a reader since its last call; moves its cursor on."""
        with self._lock:
            return self._fleet.read(cursor, self._clock_ns())

    def heartbeat(self) -> FleetView:
        """A change that holds nothing, so that a page knows the line from a silent vehicle."""
        now = rfc3339(self._clock_ns())
        return FleetView(kind="changes", now=now, vehicles=(), services=None)
