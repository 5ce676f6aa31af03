"""Pure: what a timetable consists of, as plain Structs.

Times of a trip are whole seconds after its service day's noon minus twelve hours (GTFS), so they
go past 24 hours and are right on the days when summer time begins and ends.
"""

import msgspec

from wayline.timetable.calendar import Service
from wayline.timetable.notes import Note

UNTIMED = -1
"""In `Timing`: the feed gives no time there."""


class Part(msgspec.Struct, frozen=True, array_like=True, gc=False):
    """A part of a timetable; its fields are kept by position, without their names.

    None can hold itself, so the collector of garbage need not look at hundreds of thousands.
    """


class Agency(Part, frozen=True):
    """Who runs the trips."""

    agency_id: str
    name: str
    timezone: str


class TimetableRoute(Part, frozen=True):
    """A line as passengers know it; its trips follow one or more patterns."""

    route_id: str
    agency_id: str
    short_name: str
    long_name: str


class TimetableStop(Part, frozen=True):
    """A stop of the feed."""

    stop_id: str
    name: str
    lat_deg: float
    lon_deg: float


class Shape(Part, frozen=True):
    """A line on the ground, in degrees."""

    shape_id: str
    lats_deg: tuple[float, ...]
    lons_deg: tuple[float, ...]


class Pattern(Part, frozen=True):
    """The stops and the line that trips have in common."""

    pattern_id: str
    """Of the route and the direction (`5A-1`), with a number where there are several."""
    route_id: str
    direction_id: int | None
    shape: int | None
    """In the timetable's shapes; without one the line goes straight from stop to stop."""
    stops: tuple[int, ...]
    """In the timetable's stops, in order of travel."""
    sequences: tuple[int, ...]
    """The feed's own `stop_sequence` of each stop."""


class Timing(Part, frozen=True):
    """Times at every stop of a pattern, in seconds after a trip's first time."""

    arrivals_s: tuple[int, ...]
    departures_s: tuple[int, ...]
    timepoints: tuple[bool, ...]
    """Whether the feed says that a vehicle waits there for its time."""


class Trip(Part, frozen=True):
    """A trip of a service day."""

    trip_id: str
    pattern: int
    timing: int
    service: int
    starts_s: int
    block_id: str | None
    headsign: str


class Frequency(Part, frozen=True):
    """A trip that is repeated from start to end every `headway_s`."""

    trip: int
    start_s: int
    end_s: int
    headway_s: int
    exact: bool
    """Departures are as computed; else only the distance between vehicles is promised."""


class Timetable(Part, frozen=True):
    """A feed as it is used; parts name each other by their places in these tuples."""

    source: str
    """Where it came from, for warnings."""
    fingerprint: str
    agencies: tuple[Agency, ...]
    routes: tuple[TimetableRoute, ...]
    stops: tuple[TimetableStop, ...]
    shapes: tuple[Shape, ...]
    services: tuple[Service, ...]
    patterns: tuple[Pattern, ...]
    timings: tuple[Timing, ...]
    trips: tuple[Trip, ...]
    frequencies: tuple[Frequency, ...]
    timezone: str
    notes: tuple[Note, ...]
