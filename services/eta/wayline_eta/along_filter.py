"""Pure: how far along its route a vehicle is that reports seldom.

A point-mass filter: some hundred vehicles that may be the one, each with its place, its pace, its
usual dwell, and where it stands the time that it still will. Between reports they go on as
`ExpectedMotion` has it; a report leaves those that are where it says. So a report at a stop tells
that the vehicle stands there, one far on that it drives faster than planned, and the middle of
them all is where it likely is. Their numbers come from a fixed table: nothing is left to chance.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtri

from wayline_eta.expected_motion import ExpectedMotion
from wayline_eta.stands import MOVING, TAIL, Stand

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]

POINTS = 320
PACE_STD = 0.12
"""Of the logarithm of the vehicle's pace (its speed over the planned one), before it is known."""
PACE_WALK = 0.015
"""Of its change from one report to the next."""
LEG_STD = 0.12
"""Of the logarithm of one leg's pace about the vehicle's own: from stop to stop."""
HELD_UP, HELD_UP_PACE, USUAL_PACE = 0.08, 0.6, 1.05
"""So many legs have lights or queues that make them so much slower; the rest is a little faster."""
EXTRA_STD_S, EXTRA_UNTOLD_STD_S, EXTRA_WALK_S = 3.0, 8.0, 0.7
"""Of the vehicle's usual dwell beyond the planned one, or beyond what is taken for it where no
dwell is planned, before it is known; of its change."""
DWELL_STD_S = 5.0
"""Of one dwell about the usual one."""
UNEXPECTED = 0.02
"""Likelihood of a report that nothing expected, of 1 for one where all points are: so many more
points are put where it says as it was less expected."""
ANEW_STANDS = 0.6
"""Of those put at a stop; elsewhere a fifth of that."""
STAND_S = 8.0
"""Between stops a stand lasts at least about so long."""
NEAR_STOP_M = 20.0
PLACE_STD_M = 5.0
"""Lines, stops and antennas are off by so much besides a report's own error."""
TERMINAL_S = 60.0
"""Where an open route begins vehicles wait, whether or not that is their time."""
FOR_GOOD_S = 1e6
"""Where an open route ends they stay."""
OVERDUE_SHARE = 0.3
"""At a stop, where a dwell is over: so much of such a stand."""
CONTRADICTED = 0.002
"""What is left of a point that drives where the report says that it stands, or the other way."""
ROWS = 61


def _even_rows() -> Floats:
    """Numbers between 0 and 1, in each row evenly spread and in an order of its own."""
    order = np.random.default_rng(ROWS)
    return np.array([(order.permutation(POINTS) + 0.5) / POINTS for _ in range(ROWS)])


EVEN = _even_rows()
NORMAL: Floats = ndtri(EVEN)
"""As many numbers of the standard normal distribution."""


class Along(NamedTuple):
    """What is expected of the vehicle at one instant."""

    total_m: float
    """The median."""
    std_m: float
    speed_mps: float
    """0 where it stands."""
    stand: Stand
    stood_s: float
    """Since it came to stand where it is; 0 under way."""


class Points(NamedTuple):
    """Vehicles that may be the one; each of shape (n,)."""

    totals_m: Floats
    paces: Floats
    leg_paces: Floats
    extras_s: Floats
    left_s: Floats
    """Still to stand."""
    stood_s: Floats
    """Since they came to stand; 0 for those that drive."""


class AlongFilter:
    """Of one vehicle on one route, from the first report on."""

    def __init__(
        self, motion: ExpectedMotion, t_ns: int, total_m: float, std_m: float, speed_mps: float
    ) -> None:
        """`speed_mps` is its speed where that is known, else 0."""
        self._motion = motion
        self._drawn = 0
        pace = speed_mps / motion.speed_mps(total_m) if speed_mps > 0.0 else 1.0
        self._points = self._beginning(total_m, std_m, min(max(pace, 0.5), 2.0))
        self._t_ns = t_ns
        self._ahead, self._ahead_ns = self._points, t_ns
        """As far as anything was told."""

    def run_as(self, motion: ExpectedMotion) -> None:
        """Go on by another plan of the same line."""
        self._motion = motion

    def at(self, t_ns: int) -> Along:
        """What is expected of an instant at or after the last report."""
        if t_ns < self._ahead_ns:
            self._ahead, self._ahead_ns = self._points, self._t_ns
        self._ahead = self._gone_on(self._ahead, self._ahead_ns, t_ns)
        self._ahead_ns = max(t_ns, self._ahead_ns)
        return self._told(self._ahead)

    def report(self, t_ns: int, place_m: float, std_m: float, *, moves: bool | None) -> None:
        """Take where the vehicle was; `moves` where the report itself says whether it does."""
        points = self._gone_on(self._points, self._t_ns, t_ns)
        std_m = float(np.hypot(std_m, PLACE_STD_M))
        weights = np.exp(-0.5 * ((points.totals_m - place_m) / std_m) ** 2)
        if moves is not None:
            weights = np.where((points.left_s > 0.0) == moves, CONTRADICTED, 1.0) * weights
        expected = float(np.mean(weights))
        anew = self._even() < UNEXPECTED / (UNEXPECTED + expected)
        chosen = _evenly(weights + 1e-12, POINTS)
        points = Points(*(part[chosen] for part in points))
        points = self._anew(points, anew, place_m, std_m, moves=moves)
        self._points, self._t_ns = self._renewed(points, t_ns), t_ns
        self._ahead, self._ahead_ns = self._points, t_ns

    def _beginning(self, total_m: float, std_m: float, pace: float) -> Points:
        zeros = np.zeros(POINTS)
        points = Points(
            np.full(POINTS, total_m),
            pace * np.exp(PACE_STD * self._normal()),
            self._leg_paces(),
            (EXTRA_UNTOLD_STD_S if self._motion.is_untold else EXTRA_STD_S) * self._normal(),
            zeros,
            zeros,
        )
        return self._anew(points, np.full(POINTS, True), total_m, std_m, moves=None)

    def _anew(
        self, points: Points, anew: Flags, place_m: float, std_m: float, *, moves: bool | None
    ) -> Points:
        """Some points put where the report says: standing, at a stop above all, or driving."""
        stop = self._motion.stop_near(place_m, NEAR_STOP_M, NEAR_STOP_M)
        stands_share = ANEW_STANDS if stop else ANEW_STANDS / 5.0
        stands_share = stands_share if moves is None else 1.0 - float(moves)
        stands = anew & (self._even() < stands_share)
        totals_m = place_m + std_m * self._normal()
        totals_m = np.where(stands, stop[0] if stop else place_m, totals_m)
        dwells_s = STAND_S * np.ones(POINTS)
        if stop:
            dwells_s = np.maximum(self._motion.dwells_s[stop[1]] + points.extras_s, 2.0)
        if stop and stop[0] <= self._motion.start_m:
            dwells_s = np.maximum(dwells_s, TERMINAL_S)
        stood_s = dwells_s * self._even()
        return points._replace(
            totals_m=np.where(anew, totals_m, points.totals_m),
            left_s=np.where(anew, np.where(stands, dwells_s - stood_s, 0.0), points.left_s),
            stood_s=np.where(anew, np.where(stands, stood_s, 0.0), points.stood_s),
        )

    def _renewed(self, points: Points, t_ns: int) -> Points:
        """With what has changed since the last report, and the rest of each stand drawn anew."""
        paces = points.paces * np.exp(PACE_WALK * self._normal())
        extras_s = points.extras_s + EXTRA_WALK_S * self._normal()
        return points._replace(
            paces=np.clip(paces, 0.3, 2.5),
            extras_s=np.clip(extras_s, -60.0, 90.0),
            left_s=np.where(points.left_s > 0.0, self._still_stands_s(points, t_ns), 0.0),
        )

    def _still_stands_s(self, points: Points, t_ns: int) -> Floats:
        """The rest of a dwell, given how long it has lasted; what outlasts it is a stand."""
        places_m, which = self._motion.next_stops(points.totals_m - 0.02)
        at_stop = np.abs(places_m - points.totals_m) < 0.1
        usual_s = np.where(at_stop, self._dwells_s(which, points.extras_s), 0.0)
        dwells_s = usual_s + DWELL_STD_S * self._normal()
        overdue_s = self._overdue_s(which, t_ns)
        over_s = np.minimum(points.stood_s - usual_s, overdue_s)
        over_s = np.maximum(over_s - DWELL_STD_S, 0.0)
        at_start = at_stop & (points.totals_m <= self._motion.start_m) & np.isinf(overdue_s)
        tail_s = (np.where(at_start, TERMINAL_S, STAND_S) + over_s) * (
            self._even() ** (-1.0 / TAIL) - 1.0
        )
        rest_s = dwells_s - points.stood_s
        tail_s = np.where(at_stop & ~at_start, OVERDUE_SHARE, 1.0) * tail_s
        stands_s = np.where(at_stop & (rest_s > 0.0), rest_s, tail_s)
        waits_s = np.where(at_stop, self._waits_s(which, np.full(POINTS, float(t_ns))), 0.0)
        return np.maximum(stands_s, waits_s)

    def _overdue_s(self, which: NDArray[np.intp], t_ns: int) -> Floats:
        """Since the vehicle might leave stops; without end where it always may."""
        if not len(self._motion.leaves_ns):
            return np.full(len(which), np.inf)
        return np.asarray((t_ns - self._motion.leaves_ns[which]) * 1e-9)

    def _waits_s(self, which: NDArray[np.intp], times_ns: Floats) -> Floats:
        """Until the vehicle may leave stops, of those that it has come to at instants."""
        if not len(self._motion.leaves_ns):
            return np.zeros(len(which))
        return np.asarray(np.maximum(self._motion.leaves_ns[which] - times_ns, 0.0) * 1e-9)

    def _gone_on(self, points: Points, from_ns: int, to_ns: int) -> Points:
        """After some time, from stop to stop."""
        seconds = (to_ns - from_ns) * 1e-9
        if seconds <= 0.0:
            return points
        totals_m, leg_paces = points.totals_m.copy(), points.leg_paces.copy()
        left_s, stood_s = points.left_s.copy(), points.stood_s.copy()
        budget_s = np.full(len(totals_m), seconds)
        while True:
            waits_s = np.minimum(left_s, budget_s)
            left_s, budget_s = left_s - waits_s, budget_s - waits_s
            stood_s = np.where(budget_s > 0.0, 0.0, stood_s + waits_s)
            if not np.any(budget_s > 0.0):
                break
            driven_s = self._motion.driven_s(totals_m)
            stops_m, which = self._motion.next_stops(totals_m)
            ends_m = np.where(np.isfinite(stops_m), stops_m, totals_m)
            speed = points.paces * leg_paces
            legs_s = (self._motion.driven_s(ends_m) - driven_s) / speed
            comes = np.isfinite(stops_m) & (legs_s <= budget_s) & (budget_s > 0.0)
            on_m = self._motion.distance_at(driven_s + budget_s * speed)
            totals_m = np.where(comes, stops_m, np.where(budget_s > 0.0, on_m, totals_m))
            dwells_s = self._dwells_s(which, points.extras_s) + DWELL_STD_S * self._normal()
            leg_paces = np.where(comes, self._leg_paces(), leg_paces)
            budget_s = np.where(comes, budget_s - legs_s, 0.0)
            dwells_s = np.maximum(dwells_s, self._waits_s(which, to_ns - budget_s * 1e9))
            dwells_s = np.where(stops_m >= self._motion.end_m, FOR_GOOD_S, dwells_s)
            left_s = np.where(comes, np.maximum(dwells_s, 0.0), left_s)
        return points._replace(
            totals_m=totals_m, leg_paces=leg_paces, left_s=left_s, stood_s=stood_s
        )

    def _dwells_s(self, which: NDArray[np.intp], extras_s: Floats) -> Floats:
        if not len(self._motion.dwells_s):
            return np.zeros(len(which))
        return np.maximum(self._motion.dwells_s[which] + extras_s, 0.0)

    def _leg_paces(self) -> Floats:
        held_up = self._even() < HELD_UP
        usual = np.where(held_up, HELD_UP_PACE, USUAL_PACE)
        return np.asarray(usual * np.exp(LEG_STD * self._normal()))

    def _even(self) -> Floats:
        """Numbers between 0 and 1, evenly spread over the points; in another order at each call."""
        self._drawn += 1
        return np.asarray(EVEN[self._drawn % ROWS])

    def _normal(self) -> Floats:
        self._drawn += 1
        return np.asarray(NORMAL[self._drawn % ROWS])

    def _told(self, points: Points) -> Along:
        stands = points.left_s > 0.0
        middle_m = float(np.median(points.totals_m))
        std_m = float(np.std(points.totals_m))
        if np.count_nonzero(stands) * 2 > POINTS:
            stand = Stand(*np.quantile(points.left_s, (0.1, 0.5, 0.9)).tolist())
            if middle_m >= self._motion.end_m - 0.1:
                stand = MOVING  # there is nothing that it would be late for
            return Along(middle_m, std_m, 0.0, stand, float(np.median(points.stood_s[stands])))
        pace = float(np.median((points.paces * points.leg_paces)[~stands]))
        return Along(middle_m, std_m, pace * self._motion.speed_mps(middle_m), MOVING, 0.0)


def _evenly(weights: Floats, count: int) -> NDArray[np.intp]:
    """Indices in proportion to their weights (systematic resampling from the middle)."""
    marks = (np.arange(count) + 0.5) / count
    found = np.searchsorted(np.cumsum(weights / weights.sum()), marks)
    return np.minimum(found, len(weights) - 1)
