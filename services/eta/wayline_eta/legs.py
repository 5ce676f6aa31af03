"""Pure: what a vehicle takes from stop to stop, and at each, by its own progress.

A leg is named by the stops at its ends, so that lines that share it teach each other; a route that
is no timetable's has stop ids of its own, and its legs are named with the route.
"""

import itertools
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wayline.route import Route

Floats = NDArray[np.float64]


class Leg(NamedTuple):
    """From one stop of a route to the next, as planned."""

    key: str
    """The same for every trip over it."""
    start_m: float
    """Where its first stop is; on a loop the last leg ends beyond the end of the line."""
    end_m: float
    planned_s: float
    """Without any dwell."""


class Legs:
    """The legs of a route between its stops, leg i from stop i on; a loop's last goes to the first.

    `scope` names whose stop ids these are.
    """

    def __init__(self, route: Route, scope: str) -> None:
        self.route = route
        self.keys = [f"{scope}|{stop.stop_id}" for stop in route.stops]
        """Of the stops, under which their dwells are known."""
        self.legs = self._between_stops(scope)

    def _between_stops(self, scope: str) -> list[Leg]:
        route = self.route
        ends = list(itertools.pairwise(range(len(route.stops))))
        if route.loop and len(route.stops) > 1:
            ends.append((len(route.stops) - 1, 0))
        found = []
        for first, last in ends:
            start_m, end_m = route.stop_distances_m[first], route.stop_distances_m[last]
            end_m += route.length_m if end_m <= start_m and route.loop else 0.0
            times_s = route.time_at(np.array([start_m, end_m]))
            key = f"{scope}|{route.stops[first].stop_id}>{route.stops[last].stop_id}"
            found.append(
                Leg(key, float(start_m), float(end_m), max(float(times_s[1] - times_s[0]), 1.0))
            )
        return found

    def to(self, stop: int) -> Leg | None:
        """The leg that ends at a stop; None of the first one of an open route."""
        if stop > 0:
            return self.legs[stop - 1]
        return self.legs[-1] if self.route.loop and self.legs else None


class Driven(NamedTuple):
    """What a vehicle took for a leg and at the stop where that ends."""

    leg: Leg | None
    """None where the way to the stop was not seen from a stop on."""
    travel_s: float
    stop: int
    arrived_ns: int
    dwell_s: float
    """0 where it passed."""


class Seen(NamedTuple):
    """Where a vehicle was; along the route over all laps."""

    t_ns: int
    total_m: float
    speed_mps: float


class LegObserver:
    """Of one vehicle on one route: which legs it has driven, from its place second by second.

    It arrives at a stop where it first stands within `stop_radius_m`, else passes (SPEC section
    8); it departs when it is beyond that again. A gap of more than `gap_s`, or a place that falls
    back, begins anew.
    """

    def __init__(self, legs: Legs, *, radius_m: float, standing_mps: float, gap_s: float) -> None:
        self._legs = legs
        self._radius_m, self._standing_mps = radius_m, standing_mps
        self._gap_ns = round(gap_s * 1e9)
        self._last: Seen | None = None
        self._at: tuple[int, int] | None = None
        """The stop at which it stands or which it passes, and its lap."""
        self._arrived_ns = 0
        self._departed: tuple[int, int] | None = None
        """From which stop (counted over laps) it left, and when."""

    @property
    def stands_at(self) -> int | None:
        """The stop at which it is; None under way."""
        return None if self._at is None else self._at[0]

    @property
    def stands_since_ns(self) -> int | None:
        """Since when it has been at the stop where it is; None under way."""
        return self._arrived_ns if self._at is not None else None

    def observe(self, seen: Seen) -> Driven | None:
        """Take its next place; what it took, once it has left a stop."""
        last, self._last = self._last, seen
        if last is None or not self._goes_on(last, seen):
            self._at = self._departed = None
            return None
        if self._at is None:
            self._reach(last, seen)
        return self._leave(last, seen)

    def _goes_on(self, last: Seen, seen: Seen) -> bool:
        is_near = seen.t_ns - last.t_ns <= self._gap_ns
        return is_near and seen.total_m >= last.total_m - self._radius_m

    def _place_m(self, at: tuple[int, int]) -> float:
        stop, lap = at
        route = self._legs.route
        return float(route.stop_distances_m[stop]) + (lap * route.length_m if route.loop else 0.0)

    def _next(self, after_m: float) -> tuple[int, int] | None:
        """The first stop beyond a place, and the lap in which that is."""
        route = self._legs.route
        if not len(route.stops):
            return None
        lap = int(after_m // route.length_m) if route.loop else 0
        for each in (lap, lap + 1) if route.loop else (0,):
            offset_m = each * route.length_m if route.loop else 0.0
            beyond = np.flatnonzero(route.stop_distances_m + offset_m > after_m)
            if len(beyond):
                return int(beyond[0]), each
        return None

    def _reach(self, last: Seen, seen: Seen) -> None:
        at = self._next(last.total_m - self._radius_m)
        if at is None:
            return
        place_m = self._place_m(at)
        is_standing = seen.speed_mps < self._standing_mps
        if is_standing and abs(seen.total_m - place_m) <= self._radius_m:
            self._at, self._arrived_ns = at, seen.t_ns
        elif seen.total_m > place_m:
            self._at, self._arrived_ns = at, _passed_ns(last, seen, place_m)

    def _leave(self, last: Seen, seen: Seen) -> Driven | None:
        if self._at is None:
            return None
        place_m = self._place_m(self._at)
        if seen.total_m <= place_m + self._radius_m:
            return None
        (stop, lap), self._at = self._at, None
        stood = last.speed_mps < self._standing_mps or last.total_m <= place_m + self._radius_m
        left_ns = _passed_ns(last, seen, place_m + self._radius_m) if stood else self._arrived_ns
        left_ns = max(left_ns, self._arrived_ns)
        number = lap * len(self._legs.route.stops) + stop
        departed, self._departed = self._departed, (number, left_ns)
        leg, travel_s = None, 0.0
        if departed is not None and departed[0] == number - 1:
            leg = self._legs.to(stop)
            travel_s = (self._arrived_ns - departed[1]) * 1e-9
        return Driven(leg, travel_s, stop, self._arrived_ns, (left_ns - self._arrived_ns) * 1e-9)


def _passed_ns(last: Seen, seen: Seen, place_m: float) -> int:
    """When a place between two was passed."""
    way_m = seen.total_m - last.total_m
    if way_m <= 0.0:
        return seen.t_ns
    share = min(max((place_m - last.total_m) / way_m, 0.0), 1.0)
    return last.t_ns + round(share * (seen.t_ns - last.t_ns))
