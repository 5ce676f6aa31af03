"""Pure: what the core hands to its store."""

from collections.abc import Mapping
from typing import Literal

import msgspec

from wayline.core import Record
from wayline.messages import Trip
from wayline_history.layouts import US, Kind

EventKind = Literal[
    "mode", "outage", "rejected", "off_route", "stop", "service_up", "service_down", "gap"
]


class Event(msgspec.Struct, frozen=True, kw_only=True):
    """Something that happened; one that is told again under its kind, name and time has gone on."""

    t_ns: int
    kind: EventKind
    name: str = ""
    """What it is about: a mode, a sensor with a reason, a route, a stop, a service."""
    until_ns: int | None = None
    """Of what lasts: its end, or how far it is known to have gone on; null while it is open."""
    count: int | None = None
    lat_deg: float | None = None
    lon_deg: float | None = None
    detail: str | None = None


class Rows(msgspec.Struct, frozen=True):
    """Rows of one kind, see `wayline_history.layouts`."""

    rows: tuple[tuple[int, ...], ...]
    texts: tuple[str, ...] = ()


class Piece(Record, frozen=True, kw_only=True):
    """What has come of a vehicle since the last piece."""

    rows: Mapping[Kind, Rows] = {}
    events: tuple[Event, ...] = ()
    trips: tuple[Trip, ...] = ()
    under_way: Trip | None = None
    """A trip that goes on, as far as it has come."""
    is_last: bool = False
    """Input has ended."""

    def span_ns(self) -> tuple[int, int] | None:
        """Its first and last instant; None where it holds no rows and no events."""
        times = [row[0] * US for each in self.rows.values() for row in each.rows]
        times += [event.t_ns for event in self.events]
        return (min(times), max(times)) if times else None
