"""Pure: a trip of a timetable as a route: the pattern's line, at the trip's own speeds."""

from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wayline.line import Line
from wayline.route import Route, make_route
from wayline.stops import Stop
from wayline.timetable.model import UNTIMED, Pattern, Timetable, Timing, Trip
from wayline.timetable.notes import Notes
from wayline.timetable.placing import PlacedPattern, place_pattern
from wayline.timetable.plan import BAYS_M, FASTEST_MPS, WALKING_MPS, Plan, make_plan
from wayline.timetable.section_speeds import SectionSpeeds
from wayline.timetable.whole_minutes import meant_times

Floats = NDArray[np.float64]
FILE = "stop_times.txt"


class TripRoute(NamedTuple):
    """A trip's route, and when the timetable has it at its stops."""

    route: Route
    plan: Plan
    """Times after the trip's start, one a stop of the route."""
    sequences: tuple[int, ...]
    """The feed's `stop_sequence` of each stop."""
    timepoints: tuple[bool, ...]
    """Stops where a vehicle waits for its time: those that the feed names, and the first."""


class PatternRoutes:
    """Routes of one pattern's trips on one line; a vertex lies at each stop.

    Raises InputError where the pattern has no line; its misfits are noted.
    """

    def __init__(self, timetable: Timetable, pattern: Pattern, notes: Notes) -> None:
        self.pattern = pattern
        self._timetable = timetable
        self._placed = place_pattern(timetable, pattern, notes)
        self.line = _with_vertices_at(self._placed.line, self._placed.alongs_m)
        self._alongs_m = np.clip(self._placed.alongs_m, 0.0, self.line.length_m)
        self._speeds = SectionSpeeds(self.line, self._alongs_m)

    @property
    def _some_timing(self) -> Timing:
        """Of a trip of this pattern, whichever: its line and places are every trip's."""
        place = self._timetable.patterns.index(self.pattern)
        trip = next(trip for trip in self._timetable.trips if trip.pattern == place)
        return self._timetable.timings[trip.timing]

    @cached_property
    def some_route(self) -> Route:
        """Of a trip of this pattern, whichever, for who follows its line only."""
        return self.of_timing(self._some_timing, "").route

    def plan_of(self, timing: Timing) -> Plan:
        """When a trip of this timing is at the pattern's stops, in the order of driving."""
        return make_plan(self._placed.alongs_m, *_times(self._placed, timing))

    def _meant_plan(self, plan: Plan, timing: Timing) -> Plan:
        """How it is driven: times in whole minutes are rounded ones, but for waits among them."""
        if plan.slow.any():
            return plan
        alongs_m, waits = self._placed.alongs_m, np.array(timing.timepoints, dtype=np.bool_)
        waits = waits[list(self._placed.rows)]
        return make_plan(alongs_m, *meant_times(alongs_m, *_times(self._placed, timing), waits))

    def of_trip(self, trip: Trip) -> TripRoute:
        """The route at the speeds and with the dwells of a trip."""
        return self.of_timing(self._timetable.timings[trip.timing], trip.headsign)

    def of_timing(self, timing: Timing, name: str) -> TripRoute:
        """The route at the speeds and with the dwells of a timing."""
        plan = self.plan_of(timing)
        meant = self._meant_plan(plan, timing)
        where = f"{self._timetable.source} pattern {self.pattern.pattern_id}"
        checked = make_route(
            where,
            route_id=self.pattern.pattern_id,
            name=name or self.pattern.route_id,
            loop=False,
            vertices=list(
                zip(self.line.lats_deg.tolist(), self.line.lons_deg.tolist(), strict=True)
            ),
            speeds_mps=self._speeds.of_plan(meant).tolist(),
            stops=(),
        )
        kept = _once(self._placed)
        stops = [self._stop(row, last, meant) for row, last in kept]
        route = Route(
            route_id=checked.route_id,
            name=checked.name,
            loop=False,
            line=checked.line,
            speeds_mps=checked.speeds_mps,
            stops=stops,
        )
        first, final = (np.array(each, dtype=np.intp) for each in zip(*kept, strict=True))
        at_stops = Plan(
            plan.arrivals_s[first],
            plan.departures_s[final],
            plan.untimed[first],
            plan.impossible[first],
            plan.slow[final],
        )
        sequences = tuple(self.pattern.sequences[self._placed.rows[row]] for row, _ in kept)
        timepoints = tuple(
            at == 0 or any(timing.timepoints[self._placed.rows[row]] for row in range(a, b + 1))
            for at, (a, b) in enumerate(kept)
        )
        return TripRoute(route, at_stops, sequences, timepoints)

    def _stop(self, row: int, last: int, plan: Plan) -> Stop:
        dwell_s = float(plan.departures_s[last] - plan.arrivals_s[row])
        place = self._placed.stops[row]
        return Stop(
            place.stop_id,
            place.name,
            place.lat_deg,
            place.lon_deg,
            round(max(dwell_s, 0.0), 1),
            float(self._alongs_m[row]),
        )


def note_times(routes: PatternRoutes, timing: Timing, trip_id: str, notes: Notes) -> None:
    """Note what a timing has that could not be driven as it stands."""
    plan = routes.plan_of(timing)
    if plan.impossible.any():
        fault = f"times that fall or need more than {FASTEST_MPS:g} m/s: interpolated"
        notes.add("mended", FILE, fault, f"trip {trip_id}")
    if plan.slow.any():
        fault = f"legs slower than {WALKING_MPS:g} m/s, or waits written as legs: taken as dwell"
        notes.add("mended", FILE, fault, f"trip {trip_id}")


def _times(placed: PlacedPattern, timing: Timing) -> tuple[Floats, Floats]:
    """In the order of driving; times of exchanged stops go with them where that makes them rise."""
    rows = list(placed.rows)
    arrivals_s = np.array(timing.arrivals_s, dtype=np.float64)
    departures_s = np.array(timing.departures_s, dtype=np.float64)
    arrivals_s[arrivals_s == UNTIMED] = np.nan
    departures_s[departures_s == UNTIMED] = np.nan
    moved_s = arrivals_s[rows]
    known_s = moved_s[~np.isnan(moved_s)]
    if np.all(np.diff(known_s) >= 0.0):
        arrivals_s, departures_s = moved_s, departures_s[rows]
    return arrivals_s, departures_s


def _once(placed: PlacedPattern) -> list[tuple[int, int]]:
    """First and last row of each stop: the same stop in rows that follow each other is one."""
    spans: list[tuple[int, int]] = []
    for row, stop in enumerate(placed.stops):
        same = spans and placed.stops[spans[-1][0]].stop_id == stop.stop_id
        if same and placed.alongs_m[row] - placed.alongs_m[spans[-1][0]] <= BAYS_M:
            spans[-1] = (spans[-1][0], row)
        else:
            spans.append((row, row))
    return spans


def _with_vertices_at(line: Line, alongs_m: Floats) -> Line:
    """A line with vertices added at distances along it."""
    distances_m = np.unique(np.round(np.concatenate((line.distances_m, alongs_m)), 2))
    points = np.array([line.point_at(float(distance_m))[:2] for distance_m in distances_m])
    return Line(points[:, 0], points[:, 1])
