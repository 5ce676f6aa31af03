"""Keeps when services went and came back."""

from collections.abc import Callable

from wayline.core import Record
from wayline.host_clock import told_ns
from wayline_history.records import Event, Piece


class AttendanceLog:
    """Told of every service that comes and goes; the host's clock says when.

    A service that was there when the history began, or is new, is not told of: only one that went
    and came back.
    """

    def __init__(self, keep: Callable[[str, Record], None]) -> None:
        self._keep = keep
        self._gone: set[tuple[str, str]] = set()

    def note(self, vehicle_id: str, service: str, is_up: bool) -> None:
        """A service of a vehicle, or of the fleet, has come or gone."""
        who = vehicle_id, service
        if is_up and who not in self._gone:
            return
        (self._gone.discard if is_up else self._gone.add)(who)
        event = Event(t_ns=told_ns(), kind="service_up" if is_up else "service_down", name=service)
        self._keep(vehicle_id, Piece(events=(event,)))
