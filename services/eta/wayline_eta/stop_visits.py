"""Pure: which stops a vehicle has served, and how long it is still to stand at one.

Arrival is the instant the vehicle first stands within `tuning.stop_radius_m` of a stop, else
passes it (SPEC section 8).
"""

import math

import numpy as np
from numpy.typing import NDArray

from wayline.route import Route
from wayline.tuning import Tuning
from wayline_eta.stands import MOVING, Stand, goes_on

Floats = NDArray[np.float64]

STANDS_WITHIN_M = 20.0
"""A vehicle that creeps on by less stands on: queues do."""
BOARDING_S = 20.0
"""At stops where vehicles wait for their time the plan's dwell is mostly that: late ones board."""
GOES_BACK_M = 100.0
"""A place this far behind the last served stop is a new trip (or a mistake undone)."""
BRAKING_MPS2 = 1.0
"""Of a bus with standing passengers that comes to a stop."""
SAME_M = 1e-3
"""Places of one stop, summed over laps, differ by less: sums are rounded."""


class StopVisits:
    """Follows one vehicle on one route; distances go on growing over a loop's laps."""

    def __init__(self, route: Route, tuning: Tuning) -> None:
        self._route, self._tuning = route, tuning
        self._served_m: float | None = None
        self._stood_at_m: float | None = None
        self._leaves_ns = 0
        self._dwells_s = route.stop_dwells_s
        self._earliest_ns = np.full(len(route.stops), -np.inf)
        self._stands_at_m: float | None = None
        """Where it stands, at a stop or not; None while it drives."""
        self._stands_since_ns = 0

    @property
    def served_m(self) -> float:
        """Stops up to here have been arrived at."""
        return 0.0 if self._served_m is None else self._served_m

    def served_by(self, total_m: float, speed_mps: float) -> float:
        """Stops up to where a vehicle that is at a place, at a speed, has arrived at.

        Who can still stand within the radius of a stop that lies just behind has not passed it.
        """
        served_m, radius_m = self.served_m, self._tuning.stop_radius_m
        if total_m <= served_m:
            return served_m
        free_m = stands_within_m(radius_m, speed_mps)
        if free_m <= 0.0:
            return total_m
        place_m = float(
            next_visits_m(self._route, max(served_m, total_m - free_m)).min(initial=math.inf)
        )
        is_end = not self._route.loop and total_m >= self._route.length_m
        return total_m if place_m > total_m or is_end else place_m - 2.0 * SAME_M

    def run_as(self, route: Route, dwells_s: Floats, leaves_ns: Floats) -> None:
        """Go on by another plan of the same line: other dwells, other earliest departures."""
        self._route, self._dwells_s, self._earliest_ns = route, dwells_s, leaves_ns

    def observe(self, total_m: float, speed_mps: float, t_ns: int) -> None:
        """Take the vehicle's next place and speed."""
        served_m = total_m if self._served_m is None else self._served_m
        self._served_m = served_m
        self._served_m = self.served_by(total_m, speed_mps)
        if total_m < served_m - GOES_BACK_M:
            self._served_m, self._stood_at_m = total_m, None
        if abs(speed_mps) < self._tuning.eta_standing_mps:
            if self._stands_at_m is None or abs(total_m - self._stands_at_m) > STANDS_WITHIN_M:
                self._stands_at_m, self._stands_since_ns = total_m, t_ns
            self._stand(total_m, t_ns)
            return
        if abs(speed_mps) >= self._tuning.eta_moving_mps:
            self._stands_at_m = None
        if self._has_left(total_m, speed_mps):
            self._leaves_ns = 0

    def stand(self, t_ns: int) -> Stand:
        """How long it will still stand where it does: until it leaves a stop, or as stands go."""
        if self._stands_at_m is None:
            return MOVING
        due_ns = max(self._leaves_ns, self._stands_since_ns)
        overdue = goes_on(max(t_ns - due_ns, 0) * 1e-9)
        return overdue.at_least(self.dwell_left_s(t_ns))

    def dwell_left_s(self, t_ns: int) -> float:
        """Planned seconds that the vehicle will still stand at the stop where it stands."""
        return max(self._leaves_ns - t_ns, 0) * 1e-9

    def _stand(self, total_m: float, t_ns: int) -> None:
        radius_m = self._tuning.stop_radius_m
        places_m = next_visits_m(self._route, total_m - radius_m)
        near = np.flatnonzero(places_m <= total_m + radius_m)
        if not len(near):
            return
        last = near[np.argmax(places_m[near])]
        place_m = float(places_m[last])
        self._served_m = max(self.served_m, place_m)
        if place_m != self._stood_at_m:
            self._stood_at_m = place_m
            self._leaves_ns = t_ns + round(self._dwell_s(int(last), t_ns) * 1e9)

    def _dwell_s(self, stop: int, t_ns: int) -> float:
        """Planned; where the vehicle waits for its time, until then."""
        return max(float(self._dwells_s[stop]), (float(self._earliest_ns[stop]) - t_ns) * 1e-9)

    def _has_left(self, total_m: float, speed_mps: float) -> bool:
        moving = abs(speed_mps) >= self._tuning.eta_moving_mps
        stood_at_m = total_m if self._stood_at_m is None else self._stood_at_m
        return moving or abs(total_m - stood_at_m) > self._tuning.stop_radius_m


def stands_within_m(radius_m: float, speed_mps: float) -> float:
    """How far behind a stop a vehicle may be that can still stand within a radius of it."""
    return max(radius_m - speed_mps**2 / (2.0 * BRAKING_MPS2), 0.0)


def next_visits_m(route: Route, after_m: float) -> Floats:
    """Where each stop is next reached beyond a distance, shape (stops,).

    On a loop the distances go on over the laps; on an open route a stop behind is at infinity.
    """
    places_m = route.stop_distances_m
    if not route.loop:
        return np.where(places_m > after_m, places_m, math.inf)
    laps = np.floor((after_m - places_m + SAME_M) / route.length_m) + 1.0
    return np.asarray(places_m + laps * route.length_m)
