"""Pure: how vehicles that nobody sees go on along a route: by its plan, at their own pace.

They drive at the planned speeds times their pace and stand at every stop for its dwell. Plans
without dwells (most timetables) have them in their running times, from where they are taken: who
comes to a stop at its time stands there within what is planned to the next one.
"""

from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from wayline.route import Route
from wayline_eta.stop_visits import BOARDING_S

Floats = NDArray[np.float64]
Indices = NDArray[np.intp]

UNTOLD_DWELL_S = 20.0
UNTOLD_SHARE = 1.0 / 3.0
"""A stop without a planned dwell takes so much of the running time from it, the lesser of both."""
RATE_MPS2 = 2.0
"""Speeding up and braking, of a bus with standing passengers."""
HURRY_MAX = 1.2
TINY_S = 1e-3
ENDS_WITHIN_M = 50.0
"""A line that goes on no farther behind its last stop ends there."""


class ExpectedMotion:
    """Of one route; arrays of distances go on growing over a loop's laps.

    `stops_m` (shape (stops,), rising) are the places of its stops, `dwells_s` how long a vehicle
    is expected to stand there, `leaves_ns` when it leaves there at the earliest.
    """

    def __init__(self, route: Route, leaves_ns: Floats | None = None) -> None:
        self._route = route
        if leaves_ns is None:
            leaves_ns = np.full(len(route.stops), -np.inf)
        self.stop_leaves_ns = leaves_ns
        """Of every stop of the route, in its order."""
        self.stops_m, self._planned_s, self.leaves_ns, self._place_of = _once(route, leaves_ns)

    @property
    def start_m(self) -> float:
        """Where the first stop of an open route is; before everything where there is none."""
        return -np.inf if self._route.loop or not len(self.stops_m) else float(self.stops_m[0])

    @property
    def end_m(self) -> float:
        """Where the last stop of an open route is that ends there; else beyond everything."""
        if self._route.loop or not len(self.stops_m):
            return np.inf
        last_m = float(self.stops_m[-1])
        return last_m if last_m >= self._route.length_m - ENDS_WITHIN_M else np.inf

    @property
    def last_m(self) -> float:
        """Where an open route's line ends; beyond everything on a loop."""
        return np.inf if self._route.loop else self._route.length_m

    def driven_s(self, totals_m: Floats) -> Floats:
        """Seconds of driving from the start to distances, at the planned speeds, without dwells."""
        if not self._route.loop:
            return np.interp(totals_m, self._marks_m, self._times_s)
        laps, withins_m = np.divmod(totals_m, self._route.length_m)
        within_s = np.interp(withins_m, self._marks_m, self._times_s)
        return np.asarray(laps * self._times_s[-1] + within_s)

    def distance_at(self, driven_s: Floats) -> Floats:
        """The inverse of `driven_s`; an open route ends at its end."""
        if not self._route.loop:
            return np.interp(driven_s, self._times_s, self._marks_m)
        laps, withins_s = np.divmod(driven_s, self._times_s[-1])
        within_m = np.interp(withins_s, self._times_s, self._marks_m)
        return np.asarray(laps * self._route.length_m + within_m)

    def next_stops(self, totals_m: Floats) -> tuple[Floats, Indices]:
        """Where the first stops beyond distances are, and which; at infinity where none is."""
        stops, loop = len(self.stops_m), self._route.loop
        if not stops:
            return np.full(len(totals_m), np.inf), np.zeros(len(totals_m), dtype=np.intp)
        if not loop:
            which = self.stops_m.searchsorted(totals_m + 0.01, side="right")
            return self._stops_and_beyond_m[which], np.minimum(which, stops - 1)
        laps, withins_m = np.divmod(totals_m + 0.01, self._route.length_m)
        which = self.stops_m.searchsorted(withins_m, side="right")
        laps = laps + (which == stops)
        which = which % stops
        return self.stops_m[which] + laps * self._route.length_m, which

    def stop_near(self, total_m: float, before_m: float, past_m: float) -> tuple[float, int] | None:
        """The stop that is at most `before_m` ahead or `past_m` behind; None where none is."""
        places_m, which = self.next_stops(np.array([total_m - past_m]))
        if not places_m[0] <= total_m + before_m:
            return None
        return float(places_m[0]), int(which[0])

    def speeds_mps(self, totals_m: Floats) -> Floats:
        """Planned speeds under way at distances, shape (n,)."""
        withins_m = totals_m % self._route.length_m if self._route.loop else totals_m
        sections = np.searchsorted(self._marks_m, withins_m, side="right") - 1
        return np.asarray(self._speeds_mps[np.clip(sections, 0, len(self._speeds_mps) - 1)])

    def speed_mps(self, total_m: float) -> float:
        """Planned speed under way, at a distance."""
        within_m = total_m % self._route.length_m if self._route.loop else total_m
        section = int(np.searchsorted(self._marks_m, within_m, side="right")) - 1
        return float(self._speeds_mps[min(max(section, 0), len(self._speeds_mps) - 1)])

    @cached_property
    def dwells_s(self) -> Floats:
        """Shape (stops,). Where a vehicle waits for its time the plan's dwell is mostly that."""
        dwells_s = self._planned_s + self._untold_s
        waits = np.isfinite(self.leaves_ns)
        return np.where(waits, np.minimum(dwells_s, BOARDING_S), dwells_s)

    @cached_property
    def stop_dwells_s(self) -> Floats:
        """Of every stop of the route, in its order; of those at one place the last one has it."""
        dwells_s = self.dwells_s[self._place_of]
        dwells_s[:-1][np.diff(self._place_of) == 0] = 0.0
        return dwells_s

    @cached_property
    def may_be_skipped(self) -> NDArray[np.bool_]:
        """Shape (stops,): neither a timepoint nor where an open route begins or ends."""
        return self._is_on_the_way & ~np.isfinite(self.leaves_ns)

    @cached_property
    def _is_on_the_way(self) -> NDArray[np.bool_]:
        on_the_way = np.ones(len(self.stops_m), dtype=np.bool_)
        if not self._route.loop:
            on_the_way[:1] = on_the_way[-1:] = False
        return on_the_way

    @cached_property
    def hurries(self) -> Floats:
        """How much faster than planned a vehicle drives to each stop under way, shape (stops,).

        The planned time holds speeding up and braking too: it is that under way at the hurried
        speed, and the changes that this takes.
        """
        if not len(self.stops_m):
            return np.ones(1)
        before_m = self.stops_m[-1] - self._route.length_m if self._route.loop else 0.0
        marks_m = np.concatenate(([before_m], self.stops_m))
        lengths_m = np.maximum(np.diff(marks_m), 1.0)
        planned_s = np.maximum(np.diff(self.driven_s(marks_m)), TINY_S)
        changes_s = lengths_m / planned_s / RATE_MPS2
        root_s = np.sqrt(np.maximum(planned_s * (planned_s - 4.0 * changes_s), 0.0))
        return np.clip((planned_s - root_s) / (2.0 * changes_s), 1.0, HURRY_MAX)

    def beyond_m(self, totals_m: Floats) -> Floats:
        """Where one drives to beyond the last stop: to the route's end, or round."""
        length_m = self._route.length_m
        return totals_m + length_m if self._route.loop else np.maximum(length_m, totals_m)

    @property
    def is_untold(self) -> bool:
        """Whether dwells are not in the plan, so that they are guessed."""
        return bool(np.any(self._untold_s > 0.0))

    @cached_property
    def _stops_and_beyond_m(self) -> Floats:
        return np.append(self.stops_m, np.inf)

    @cached_property
    def _times_s(self) -> Floats:
        sections_s = np.diff(self._marks_m) / self._speeds_mps
        return np.concatenate(([0.0], np.cumsum(sections_s)))

    @cached_property
    def _marks_m(self) -> Floats:
        """Where the planned speed may change: at the vertices of the line and at stops."""
        line = self._route.line
        within_m = np.clip(self.stops_m, 0.0, line.length_m)
        return np.unique(np.concatenate((line.distances_m, within_m)))

    @cached_property
    def _untold_s(self) -> Floats:
        """Dwells that the running times from the stops hold: most stops have none of their own."""
        told = self._planned_s > 0.0
        if np.count_nonzero(told & self._is_on_the_way) * 2 > np.count_nonzero(self._is_on_the_way):
            return np.zeros(len(told))
        untold_s = np.minimum(UNTOLD_DWELL_S, UNTOLD_SHARE * np.roll(self._legs_s, -1))
        untold_s[told] = 0.0
        if not self._route.loop:
            untold_s[-1:] = 0.0
            untold_s[:1][np.isfinite(self.leaves_ns[:1])] = 0.0  # it leaves there at its time
        return untold_s

    @cached_property
    def _legs_s(self) -> Floats:
        """Planned running time to every stop from the one before, shape (stops,)."""
        times_s = self._route.time_at(self.stops_m)
        begins_s = times_s[-1:] - self._route.duration_s if self._route.loop else 0.0
        return np.diff(times_s, prepend=begins_s)

    @cached_property
    def _speeds_mps(self) -> Floats:
        """Planned speed between marks, without the dwells that running times hold."""
        line = self._route.line
        middles_m = (self._marks_m[:-1] + self._marks_m[1:]) / 2.0
        legs = np.searchsorted(line.distances_m, middles_m) - 1
        speeds_mps = self._route.speeds_mps[legs]
        if not len(self.stops_m):
            return np.asarray(speeds_mps)
        driving_s = self._legs_s - np.roll(self._untold_s, 1)
        factors = np.where(driving_s > 0.0, self._legs_s / np.maximum(driving_s, 1e-9), 1.0)
        leg = np.searchsorted(self.stops_m, middles_m)
        leg = leg % len(factors) if self._route.loop else np.minimum(leg, len(factors) - 1)
        return np.asarray(speeds_mps * factors[leg])


def _once(route: Route, leaves_ns: Floats) -> tuple[Floats, Floats, Floats, Indices]:
    """Places of the stops, rising, each once, with its longest dwell and its last departure.

    And which of them each stop of the route is at.
    """
    places_m = np.round(route.stop_distances_m, 2)
    once_m, place_of = np.unique(places_m, return_inverse=True)
    dwells_s, latest_ns = np.zeros(len(once_m)), np.full(len(once_m), -np.inf)
    np.maximum.at(dwells_s, place_of, route.stop_dwells_s)
    np.maximum.at(latest_ns, place_of, leaves_ns)
    return once_m, dwells_s, latest_ns, place_of
