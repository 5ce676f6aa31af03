"""Pure: how far along its route a vehicle is that reports seldom.

A point-mass filter: some hundred vehicles that may be the one, each on its way to a standstill or
standing there. Between reports they go on as `PointMotion` has it; a report leaves those that are
where it says, and as quick. So a report at a stop tells that the vehicle stands there, one far on
that it drives faster than planned, and the middle of them all is where it likely is.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wayline_eta.draws import POINTS, Draws, chosen_evenly
from wayline_eta.expected_motion import ExpectedMotion
from wayline_eta.point_motion import PointMotion
from wayline_eta.points import BETWEEN, Leg, Points
from wayline_eta.stands import MOVING, Stand

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]

PACE_STD = 0.12
"""Of the logarithm of the vehicle's pace (its speed over the planned one), before it is known."""
PACE_WALK = 0.015
"""Of its change from one report to the next."""
PACE_MIN, PACE_MAX = 0.3, 2.5
EXTRA_STD_S, EXTRA_UNTOLD_STD_S, EXTRA_WALK_S = 3.0, 10.0, 1.2
"""Of the vehicle's usual dwell beyond the planned one, or beyond what is taken for it where no
dwell is planned, before it is known; of its change."""
EXTRA_MIN_S, EXTRA_MAX_S = -60.0, 90.0
UNEXPECTED = 0.02
"""Likelihood of a report that nothing expected, of 1 for one where all points are: so many more
points are put where it says as it was less expected."""
ANEW_STANDS = 0.6
"""Of those put at a stop; elsewhere a fifth of that."""
NEAR_STOP_M = 20.0
PLACE_STD_M = 5.0
"""Lines, stops and antennas are off by so much besides a report's own error."""
SPEED_STD_MPS, SPEED_STD_SHARE = 0.7, 0.05
"""Of a reported speed, some of which are a second or two off their time."""
SPEED_RATIO_MAX = 2.0
"""What a reported speed differs by is a leg's own, up to so many times."""
RATE_STD = 0.04
"""Of the logarithm of a leg's pace from one report to the next."""
TOGETHER_S = 2.5
"""Points are put on the legs that they begin within so long together: it costs as much for one of
them as for all. Until their instants have come they stand where those begin."""
RANKS = np.arange(POINTS, dtype=np.float64)
STAND_RANKS = np.array((0.1, 0.5, 0.9)) * (POINTS - 1)
"""Of the quantiles of a stand, among all points in order."""
CONTRADICTED = 0.002
"""What is left of a point that drives where the report says that it stands, or the other way."""


class Along(NamedTuple):
    """Where a vehicle is along its route at an instant; each the middle of what may be."""

    total_m: float
    """The median."""
    std_m: float
    speed_mps: float
    """0 where it stands."""
    stand: Stand
    stood_s: float
    """Since it came to stand where it is; 0 under way."""


class AlongFilter:
    """Of one vehicle on one route, from the first report on."""

    def __init__(
        self, motion: ExpectedMotion, t_ns: int, total_m: float, std_m: float, speed_mps: float
    ) -> None:
        """`speed_mps` is its speed where that is known, else 0."""
        self._draws = Draws()
        self._begun_ns = t_ns
        self._motion = PointMotion(motion, t_ns, self._draws)
        self._points = self._beginning(total_m, std_m, speed_mps or None)
        self._ahead, self._ahead_s = self._points, 0.0
        """As they go on from the last report, and how far that is, in seconds since it began."""
        self._asked_s = 0.0
        """Of when anything was told last."""
        self._last: tuple[int, Along] | None = None
        """What was told last, of its instant: progress and arrivals ask for the same one."""

    def run_as(self, motion: ExpectedMotion) -> None:
        """Go on by another plan of the same line."""
        self._motion, self._last = PointMotion(motion, self._begun_ns, self._draws), None
        self._points, self._ahead = (
            points._replace(leg=points.leg.planned_by(motion))
            for points in (self._points, self._ahead)
        )

    def at(self, t_ns: int) -> Along:
        """What is expected of an instant at or after the last report."""
        if self._last is None or self._last[0] != t_ns:
            self._last = t_ns, self._expected((t_ns - self._begun_ns) * 1e-9)
        return self._last[1]

    def report(
        self,
        t_ns: int,
        place_m: float,
        std_m: float,
        *,
        moves: bool | None,
        speed_mps: float | None = None,
    ) -> None:
        """Take where the vehicle was, and what the report itself says of its motion.

        `moves` where it says whether it does, `speed_mps` where it says how fast.
        """
        at_s = (t_ns - self._begun_ns) * 1e-9
        std_m = float(np.hypot(std_m, PLACE_STD_M))
        under_way_mps = speed_mps if moves else None
        points = self._motion.gone_on(self._points, at_s)
        places_m = points.places_m(at_s, self._motion.motion)
        weights = _placed(places_m - place_m, std_m)
        if moves is not None:
            weights = np.where(points.stands(at_s) == moves, CONTRADICTED, 1.0) * weights
        anew = self._draws.even() < UNEXPECTED / (UNEXPECTED + float(np.mean(weights)))
        if under_way_mps is not None:
            speeds_mps = points.speeds_mps(at_s, places_m, self._motion.motion)
            weights = weights * _as_quick(speeds_mps, under_way_mps)
        points = points.chosen(chosen_evenly(weights + 1e-12))
        points = self._renewed(points, at_s, under_way_mps)
        self._points = self._anew(
            points, anew, at_s, (place_m, std_m), moves=moves, speed_mps=under_way_mps
        )
        self._ahead, self._ahead_s, self._last = self._points, at_s, None
        self._asked_s = at_s

    def _beginning(self, total_m: float, std_m: float, speed_mps: float | None) -> Points:
        zeros, places_m = np.zeros(POINTS), np.full(POINTS, total_m)
        motion = self._motion.motion
        planned_s, is_untold = motion.driven_s(places_m), motion.is_untold
        ways = places_m, places_m, zeros, np.ones(POINTS), zeros, zeros, zeros
        points = Points(
            leg=Leg(*ways, planned_s, planned_s),
            leaves_s=zeros,
            stops=np.full(POINTS, BETWEEN, dtype=np.intp),
            paces=np.exp(PACE_STD * self._draws.normal()),
            extras_s=(EXTRA_UNTOLD_STD_S if is_untold else EXTRA_STD_S) * self._draws.normal(),
        )
        every = np.full(POINTS, True)
        return self._anew(points, every, 0.0, (total_m, std_m), moves=None, speed_mps=speed_mps)

    def _anew(
        self,
        points: Points,
        anew: Flags,
        at_s: float,
        place: tuple[float, float],
        *,
        moves: bool | None,
        speed_mps: float | None,
    ) -> Points:
        """Some points put where the report says: standing, at a stop above all, or driving."""
        place_m, std_m = place
        motion = self._motion.motion
        stop = motion.stop_near(place_m, NEAR_STOP_M, NEAR_STOP_M)
        share = ANEW_STANDS if stop else ANEW_STANDS / 5.0
        share = share if moves is None else 1.0 - float(moves)
        stands = anew & (self._draws.even() < share)
        places_m = np.asarray(place_m + std_m * self._draws.normal())
        rates = None if speed_mps is None else speed_mps / motion.speeds_mps(places_m)
        points = self._motion.rolling(points, anew & ~stands, at_s, places_m, rates)
        return self._motion.standing(points, stands, at_s, stop, place_m)

    def _renewed(self, points: Points, at_s: float, speed_mps: float | None) -> Points:
        """With what has changed since the last report, and what is to come drawn anew."""
        paces = points.paces * np.exp(PACE_WALK * self._draws.normal())
        extras_s = points.extras_s + EXTRA_WALK_S * self._draws.normal()
        stands = points.stands(at_s)
        left_s = self._motion.still_stands_s(points, at_s)
        points = points._replace(
            paces=np.clip(paces, PACE_MIN, PACE_MAX),
            extras_s=np.clip(extras_s, EXTRA_MIN_S, EXTRA_MAX_S),
            leaves_s=np.where(stands, at_s + left_s, points.leaves_s),
        )
        even = ~stands & (points.phases(at_s) >= 1.0)
        places_m = points.places_m(at_s, self._motion.motion)
        rates = points.leg.rates * np.exp(RATE_STD * self._draws.normal())
        if speed_mps is not None:
            ratio = speed_mps / (rates * self._motion.motion.speeds_mps(places_m))
            rates = rates * np.clip(ratio, 1.0 / SPEED_RATIO_MAX, SPEED_RATIO_MAX)
        return self._motion.rolling(points, even, at_s, places_m, rates)

    def _expected(self, at_s: float) -> Along:
        if at_s < self._asked_s:
            self._ahead, self._ahead_s = self._points, at_s
        if at_s >= self._ahead_s:
            self._ahead_s = at_s + TOGETHER_S
            self._ahead = self._motion.gone_on(self._ahead, self._ahead_s)
        self._asked_s = at_s
        return self._told(self._ahead, at_s)

    def _told(self, points: Points, at_s: float) -> Along:
        motion, stands = self._motion.motion, points.stands(at_s)
        totals_m = points.places_m(at_s, motion)
        middle_m, std_m = _middle_of(totals_m), float(totals_m.std())
        if np.count_nonzero(stands) * 2 <= POINTS:
            speeds_mps = points.speeds_mps(at_s, totals_m, motion)
            return Along(middle_m, std_m, _middle_of(speeds_mps[~stands]), MOVING, 0.0)
        lefts_s = np.sort(points.left_s(at_s))
        stand = Stand(*np.interp(STAND_RANKS, RANKS, lefts_s).tolist())
        if middle_m >= motion.end_m - 0.1:
            stand = MOVING  # there is nothing that it would be late for
        return Along(middle_m, std_m, 0.0, stand, _middle_of(points.stood_s(at_s)[stands]))


def _placed(offs_m: Floats, std_m: float) -> Floats:
    """Likelihoods of places so far from the reported one, of 1 for the very one."""
    return np.asarray(np.exp(-0.5 * (offs_m / std_m) ** 2))


def _as_quick(speeds_mps: Floats, told_mps: float) -> Floats:
    """Likelihoods of speeds, of 1 for the reported one; forgiving to outliers."""
    std_mps = SPEED_STD_MPS + SPEED_STD_SHARE * told_mps
    return np.asarray(1.0 / (1.0 + ((speeds_mps - told_mps) / std_mps) ** 2))


def _middle_of(values: Floats) -> float:
    """The median of some; for so few numpy's own takes ten times as long."""
    ordered, half = np.sort(values), len(values) // 2
    return float(ordered[half] + ordered[-1 - half]) / 2.0
