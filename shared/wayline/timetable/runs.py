"""Pure: the trips of some feeds as they are run: on a day, from an instant to an instant."""

import datetime as dt
from collections.abc import Iterator, Sequence
from functools import cached_property
from typing import NamedTuple
from zoneinfo import ZoneInfo

import numpy as np
from numpy.typing import NDArray

from wayline.errors import InputError
from wayline.geo import metres_per_degree
from wayline.timetable.calendar import SECOND_NS, instant_ns, service_days
from wayline.timetable.model import Frequency, Pattern, Timetable, Trip
from wayline.timetable.notes import Notes
from wayline.timetable.trip_route import PatternRoutes, TripRoute
from wayline.timetable.versions import families, superseded_days

Floats = NDArray[np.float64]
LONGEST_TRIP_S = 6 * 3600
"""After a trip's first time; what begins earlier is not looked for any longer."""
SLOT_NS = 600 * SECOND_NS
"""Vehicles ask at every pose which trips there are around: within this the answer is the same."""
PatternPlace = tuple[int, int]
"""Of a feed, and of a pattern within it."""


LineKey = tuple[int, str, int | None]
"""A timetable, and of it a route and a direction."""


class Run(NamedTuple):
    """A trip on one day."""

    pattern_place: PatternPlace
    pattern: Pattern
    trip: Trip
    starts_ns: int
    """Of the plan's zero."""
    trip_route: TripRoute
    day: dt.date
    """The service day."""
    repeat_s: int | None = None
    """Of a trip that is repeated: when this time begins, by the timetable's clock."""
    is_exact: bool = True
    """Whether it is promised at its times; else only the time between two vehicles is."""

    @property
    def departs_ns(self) -> int:
        """From the first stop."""
        return self.starts_ns + _ns(self.trip_route.plan.departures_s[0])

    @property
    def ends_ns(self) -> int:
        """Arrival at the last stop."""
        return self.starts_ns + _ns(self.trip_route.plan.arrivals_s[-1])

    @property
    def leaves_ns(self) -> Floats:
        """Before when the vehicle leaves no stop, shape (stops,); minus infinity where it may."""
        departures_s = self.trip_route.plan.departures_s
        times_ns = self.starts_ns + departures_s * float(SECOND_NS)
        waits = np.asarray(self.trip_route.timepoints) & self.is_exact
        return np.where(waits, times_ns, -np.inf)

    def delay_s(self, distance_m: float, t_ns: int) -> float:
        """How late a vehicle is that is so far along at an instant; negative is early.

        Nobody is late within a stop's dwell or early before the first departure.
        """
        at_s, plan = (t_ns - self.starts_ns) / SECOND_NS, self.trip_route.plan
        alongs_m = self.trip_route.route.stop_distances_m
        before = int(np.searchsorted(alongs_m, distance_m, side="right")) - 1
        if before < 0:
            return max(at_s - float(plan.departures_s[0]), 0.0)
        if before == len(alongs_m) - 1:
            return at_s - float(plan.arrivals_s[-1])
        past_m = float(distance_m - alongs_m[before])
        between_m = np.array([alongs_m[before], distance_m, alongs_m[before + 1]])
        began_s, now_s, ends_s = self.trip_route.route.time_at(between_m).tolist()
        share = float(now_s - began_s) / max(float(ends_s - began_s), 1e-9)
        took_s = float(plan.arrivals_s[before + 1] - plan.departures_s[before])
        latest_s = earliest_s = float(plan.departures_s[before]) + share * took_s
        if past_m <= AT_STOP_M:
            earliest_s = float(plan.arrivals_s[before]) if before else -np.inf
        return max(at_s - latest_s, 0.0) + min(at_s - earliest_s, 0.0)


AT_STOP_M = 30.0
"""A vehicle that reports from so near to a stop may be standing at it."""


def _ns(seconds: float) -> int:
    return round(float(seconds) * SECOND_NS)


class Runs:
    """Every trip of some feeds, by its id, its block and its pattern."""

    def __init__(self, timetables: Sequence[Timetable]) -> None:
        self.feeds = tuple(timetables)
        self._zones = [ZoneInfo(feed.timezone) for feed in self.feeds]
        self._superseded = superseded_days(self.feeds)
        self._families = families(self.feeds)
        self._lines: dict[PatternPlace, PatternRoutes | None] = {}
        self._routes: dict[tuple[PatternPlace, int], TripRoute] = {}
        self._in_slots: dict[PatternPlace, tuple[int, list[Run]]] = {}

    def assigned(self, name: str, t_ns: int) -> list[Run]:
        """The runs of a trip or block around an instant, in the order in which they begin."""
        trips = self._named.get(name, ())
        runs = [run for feed, trip in trips for run in self._around(feed, trip, t_ns)]
        return sorted(runs, key=lambda run: run.departs_ns)

    def line_key(self, run: Run) -> LineKey:
        """What runs of one line have in common, in all versions of its timetable."""
        family = self._families[run.pattern_place[0]]
        return family, run.pattern.route_id, run.pattern.direction_id

    def of_block(self, run: Run, t_ns: int) -> list[Run]:
        """The runs of the block that a run belongs to, in order; itself alone without a block."""
        if run.trip.block_id is None:
            return [run]
        feed, _ = run.pattern_place
        runs = self.assigned(run.trip.block_id, t_ns)
        return [each for each in runs if each.pattern_place[0] == feed]

    def of_pattern(self, place: PatternPlace, t_ns: int) -> list[Run]:
        """The runs of a pattern around an instant, in the order in which they begin."""
        slot = t_ns // SLOT_NS
        known = self._in_slots.get(place)
        if known is None or known[0] != slot:
            middle_ns = slot * SLOT_NS + SLOT_NS // 2
            trips = self._of_patterns.get(place, ())
            runs = [run for trip in trips for run in self._around(place[0], trip, middle_ns)]
            known = self._in_slots[place] = slot, sorted(runs, key=lambda run: run.departs_ns)
        return known[1]

    def near(self, lat_deg: float, lon_deg: float, within_m: float) -> list[PatternPlace]:
        """The patterns whose bounding box is within a distance of a place."""
        north_m, east_m = metres_per_degree(lat_deg)
        boxes, places = self._boxes
        north = np.maximum(boxes[:, 0] - lat_deg, lat_deg - boxes[:, 1]) * north_m
        middles, halves = (boxes[:, 2] + boxes[:, 3]) / 2.0, (boxes[:, 3] - boxes[:, 2]) / 2.0
        east = (np.abs((lon_deg - middles + 180.0) % 360.0 - 180.0) - halves) * east_m
        found = np.flatnonzero((north <= within_m) & (east <= within_m))
        return [places[at] for at in found.tolist()]

    def line_of(self, place: PatternPlace) -> PatternRoutes | None:
        """The routes of a pattern; None where no line can be made of it."""
        if place not in self._lines:
            feed = self.feeds[place[0]]
            try:
                routes = PatternRoutes(feed, feed.patterns[place[1]], Notes())
            except InputError:  # reading the feed has said so
                self._lines[place] = None
            else:
                self._lines[place] = routes
        return self._lines[place]

    @cached_property
    def _named(self) -> dict[str, list[tuple[int, Trip]]]:
        named: dict[str, list[tuple[int, Trip]]] = {}
        for place, feed in enumerate(self.feeds):
            for trip in feed.trips:
                for name in {trip.trip_id, trip.block_id} - {None}:
                    named.setdefault(str(name), []).append((place, trip))
        return named

    @cached_property
    def _of_patterns(self) -> dict[PatternPlace, list[Trip]]:
        found: dict[PatternPlace, list[Trip]] = {}
        for place, feed in enumerate(self.feeds):
            for trip in feed.trips:
                found.setdefault((place, trip.pattern), []).append(trip)
        return found

    @cached_property
    def _repeats(self) -> dict[tuple[int, str], list[Frequency]]:
        found: dict[tuple[int, str], list[Frequency]] = {}
        for place, feed in enumerate(self.feeds):
            for each in feed.frequencies:
                trip_id = feed.trips[each.trip].trip_id
                found.setdefault((place, trip_id), []).append(each)
        return found

    @cached_property
    def _boxes(self) -> tuple[Floats, list[PatternPlace]]:
        """South, north, west and east of every pattern; over the antimeridian east is past 180."""
        places = [
            (at, each) for at, feed in enumerate(self.feeds) for each in range(len(feed.patterns))
        ]
        boxes = [_box(self.feeds[at], self.feeds[at].patterns[each]) for at, each in places]
        return np.array(boxes, dtype=np.float64).reshape(-1, 4), places

    def _around(self, feed: int, trip: Trip, t_ns: int) -> Iterator[Run]:
        """The runs of a trip that may be under way at an instant, or are a few hours from it."""
        place, timetable, zone = (feed, trip.pattern), self.feeds[feed], self._zones[feed]
        routes, service = self.line_of(place), timetable.services[trip.service]
        if routes is None:
            return
        for day in service_days(t_ns, zone, 2 * 86_400.0):
            if not service.runs_on(day) or day.toordinal() >= self._superseded[feed]:
                continue
            for start_s, is_exact in self._starts(feed, trip):
                starts_ns = instant_ns(day, start_s, zone)
                if abs(t_ns - starts_ns) <= LONGEST_TRIP_S * SECOND_NS:
                    route = self._route(routes, place, trip)
                    repeat_s = start_s if self._is_repeated(feed, trip) else None
                    yield Run(
                        place, routes.pattern, trip, starts_ns, route, day, repeat_s, is_exact
                    )

    def _starts(self, feed: int, trip: Trip) -> Iterator[tuple[int, bool]]:
        """When a trip begins on its days, and whether that is promised."""
        repeats = self._repeats.get((feed, trip.trip_id))
        if repeats is None:
            yield trip.starts_s, True
            return
        for each in repeats:
            for start_s in range(each.start_s, each.end_s, each.headway_s):
                yield start_s, each.exact

    def _is_repeated(self, feed: int, trip: Trip) -> bool:
        return (feed, trip.trip_id) in self._repeats

    def _route(self, routes: PatternRoutes, place: PatternPlace, trip: Trip) -> TripRoute:
        key = (place, trip.timing)
        if key not in self._routes:
            self._routes[key] = routes.of_trip(trip)
        return self._routes[key]


def _box(feed: Timetable, pattern: Pattern) -> tuple[float, float, float, float]:
    stops = [feed.stops[stop] for stop in pattern.stops]
    lats_deg = [stop.lat_deg for stop in stops]
    lons_deg = [stop.lon_deg for stop in stops]
    if pattern.shape is not None:
        lats_deg += feed.shapes[pattern.shape].lats_deg
        lons_deg += feed.shapes[pattern.shape].lons_deg
    turned = (np.array(lons_deg) - lons_deg[0] + 180.0) % 360.0 - 180.0 + lons_deg[0]
    return min(lats_deg), max(lats_deg), float(turned.min()), float(turned.max())
