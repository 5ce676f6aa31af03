"""Pure: how fast a trip is planned to go along its line, where the timetable has only its ends.

What takes its time from stop to stop in a town goes as fast all the way. What is quicker than a
town bus is on a road where nothing holds it up, but not near its stops or round corners: there it
is as slow as any bus, and the rest of the way is the quicker for it.
"""

from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from wayline.line import Line
from wayline.route import DEFAULT_SPEED_MPS
from wayline.timetable.plan import Plan

Floats = NDArray[np.float64]

TOWN_MPS = 6.0
"""From standstill to standstill in a town, lights and corners included."""
NEAR_STOP_M = 500.0
"""So far from a stop streets lead to it."""
NEAR_CORNER_M = 50.0
CORNER_DEG = 45.0
"""Who turns by more within twice NEAR_CORNER_M brakes for it."""
GRID_M = 20.0
QUICK_MPS = 28.0
"""A bus on a motorway."""


class SectionSpeeds:
    """Of the trips along one line whose stops are `alongs_m` from its start, shape (stops,)."""

    def __init__(self, line: Line, alongs_m: Floats) -> None:
        self._line, self._alongs_m = line, alongs_m

    def of_plan(self, plan: Plan) -> Floats:
        """Planned speeds, one a leg of the line."""
        moved_m, took_s = np.diff(self._alongs_m), plan.arrivals_s[1:] - plan.departures_s[:-1]
        drives = (moved_m > 0.0) & (took_s > 0.0)
        if not drives.any():
            return np.full(len(self._line.legs_m), DEFAULT_SPEED_MPS)
        ends_m, moved_m, took_s = self._alongs_m[1:][drives], moved_m[drives], took_s[drives]
        section = np.minimum(np.searchsorted(ends_m, self._middles_m), len(ends_m) - 1)
        between = (self._middles_m > self._alongs_m[0]) & (self._middles_m < self._alongs_m[-1])
        slow_m = np.bincount(section[between], self._town_m[between], len(ends_m))
        slow_mps, quick_mps = _paces(moved_m, took_s, np.minimum(slow_m, moved_m))
        quick_m = self._line.legs_m - self._town_m
        legs_s = self._town_m / slow_mps[section] + quick_m / quick_mps[section]
        return np.asarray(np.round(self._line.legs_m / legs_s, 6))

    @cached_property
    def _middles_m(self) -> Floats:
        return self._line.distances_m[:-1] + self._line.legs_m / 2.0

    @cached_property
    def _town_m(self) -> Floats:
        """How much of each leg is near a stop or a corner."""
        line = self._line
        steps = max(int(np.ceil(line.length_m / GRID_M)), 1)
        marks_m = (np.arange(steps) + 0.5) * line.length_m / steps
        is_town = self._is_near_stop(marks_m) | _turns(line, marks_m)
        ends_m = np.arange(steps + 1) * line.length_m / steps
        before_m = np.concatenate(([0.0], np.cumsum(is_town * line.length_m / steps)))
        return np.clip(np.diff(np.interp(line.distances_m, ends_m, before_m)), 0.0, line.legs_m)

    def _is_near_stop(self, marks_m: Floats) -> NDArray[np.bool_]:
        after = np.clip(np.searchsorted(self._alongs_m, marks_m), 1, len(self._alongs_m) - 1)
        ends_m = self._alongs_m[after - 1], self._alongs_m[after]
        nearest_m = np.minimum(*(np.abs(marks_m - end_m) for end_m in ends_m))
        return np.asarray(nearest_m < NEAR_STOP_M)


def _turns(line: Line, marks_m: Floats) -> NDArray[np.bool_]:
    """Whether a line turns a corner around distances along it."""
    before_deg = line.headings_deg[_legs_at(line, marks_m - NEAR_CORNER_M)]
    after_deg = line.headings_deg[_legs_at(line, marks_m + NEAR_CORNER_M)]
    turned_deg = np.abs((after_deg - before_deg + 180.0) % 360.0 - 180.0)
    return np.asarray(turned_deg > CORNER_DEG)


def _legs_at(line: Line, distances_m: Floats) -> NDArray[np.intp]:
    legs = np.searchsorted(line.distances_m, distances_m, side="right") - 1
    return np.clip(legs, 0, len(line.legs_m) - 1)


def _paces(moved_m: Floats, took_s: Floats, slow_m: Floats) -> tuple[Floats, Floats]:
    """Speeds on the slow parts of sections and on the others, so that each takes its time."""
    mean_mps, quick_m = moved_m / took_s, moved_m - slow_m
    is_mixed = (mean_mps > TOWN_MPS) & (mean_mps < QUICK_MPS) & (quick_m > 0.0) & (slow_m > 0.0)
    quick_s = np.maximum(took_s - slow_m / TOWN_MPS, quick_m / QUICK_MPS)[is_mixed]
    slow_mps, quick_mps = mean_mps.copy(), mean_mps.copy()
    slow_mps[is_mixed] = slow_m[is_mixed] / (took_s[is_mixed] - quick_s)
    quick_mps[is_mixed] = quick_m[is_mixed] / quick_s
    return slow_mps, quick_mps
