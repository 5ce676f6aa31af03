"""Pure: where along its route a vehicle is, told from all the places where it might be.

A hidden Markov model on the route's one dimension: the states are the locally nearest points of
the line, the emission is the offset and heading of the pose, the transition compares how far the
place moved along the line with how far the vehicle says it travelled. So a street that the route
passes twice is told apart by motion, and a wrong first guess is given up when it stops fitting.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wayline.geo import step_between
from wayline.messages import Pose
from wayline.route import Route
from wayline_eta.candidates import Candidates, locally_nearest

Floats = NDArray[np.float64]

LINE_STD_M = 6.0
"""How far the drawn line may lie from the lane."""
HEADING_STD_DEG = 30.0
"""How far a vehicle's heading may lie from the line's, in bends and lane changes."""
OUTLIER = 3.0
"""In sigmas: beyond it a misfit counts in proportion, no longer squared (Huber)."""
STANDING_MPS = 0.5
STANDING_M = 1.0
"""Who has come on by less between two poses stands."""
CORRELATION_S = 10.0
"""Errors of position last about so long: poses nearer in time are not new evidence."""
MOTION_SLACK_M = 5.0
MOTION_SLACK_SHARE = 0.1
"""Odometer and line disagree by so much, and by so much of the distance travelled."""
SELDOM_SLACK_M = 25.0
"""Between reports both ends are off, and the way is known by its straight line at best."""
UNLIKE_COST = 0.5
"""Lost by a place as far from where the vehicle was expected as that is away: tells ties apart."""
JUMP_COST = 12.0
"""Most that a place can lose by moving unlike the vehicle: a detour or a short cut ends so."""
FORGET_COST = 30.0
EARLIEST_COST = 0.1
"""Lost by the end of the route against its start, so that a tie is a vehicle that sets out."""
ENDS_COST = 12.0
"""Lost by a first place at the end of a circular trip: who is seen there first sets out."""
ENDS_M = 60.0
"""So near to the end, of a trip that begins as near to it."""
BEFORE_START_M = 10.0
"""A first place this near to the end of a loop is a vehicle about to start its first lap."""
UNKNOWN_STD_M = 5.0
STEADY_HEADING_STD_DEG = 45.0


class Place(NamedTuple):
    """Where a vehicle is on a route."""

    total_m: float
    """Along the route; on a loop it goes on growing over the laps."""
    cross_track_m: float
    """Of the vehicle from the route, positive to the right of the direction of travel."""
    along_std_m: float
    across_std_m: float
    turn_deg: float
    """Between the vehicle's heading and the route's, 0 to 180; 0 where it is not known."""


class _Moves(NamedTuple):
    """How far along the route a vehicle has come since it was last seen."""

    least_m: float
    most_m: float
    slack_m: float
    likely_m: float
    unlike_cost: float


class PlaceTracker:
    """The likeliest place of one vehicle on one route."""

    def __init__(self, route: Route) -> None:
        self._route = route
        self._totals_m: Floats = np.empty(0)
        self._costs: Floats = np.empty(0)
        self._last: Pose | None = None

    @property
    def is_circular(self) -> bool:
        """Whether an open route ends where it begins."""
        ends = [self._route.line.point_at(at_m)[:2] for at_m in (0.0, self._route.length_m)]
        return step_between(*ends[0], *ends[1]).distance_m < ENDS_M

    def set_out(self, pose: Pose) -> None:
        """Begin at the start, wherever else the pose might be."""
        self._totals_m, self._costs, self._last = np.zeros(1), np.zeros(1), pose

    def observe(
        self, pose: Pose, lat_deg: float, lon_deg: float, expected_m: float | None = None
    ) -> Place:
        """Take the next pose with its position in degrees, and say where the vehicle is.

        Where nobody knows the way since the last one, `expected_m` is how far along the route it
        is expected to have come; then all between that and the straight way is as likely.
        """
        candidates = locally_nearest(self._route.line, lat_deg, lon_deg)
        turns_deg = _turns_deg(pose, candidates)
        costs = self._emission(pose, candidates, turns_deg)
        if self._last is None:
            totals_m = self._first_totals(candidates)
            costs = costs + EARLIEST_COST * totals_m / self._route.length_m
            if not self._route.loop and np.any(totals_m < ENDS_M):
                ends = totals_m > self._route.length_m - ENDS_M
                costs = costs + np.where(ends, ENDS_COST, 0.0)
        else:
            moves = self._moves(self._last, pose, expected_m)
            totals_m, moved = self._transition(moves, candidates)
            costs = costs + moved
        best = int(np.argmin(costs))
        place = self._place(pose, candidates, totals_m, turns_deg, best)
        kept = costs <= costs[best] + FORGET_COST
        self._totals_m, self._costs = totals_m[kept], costs[kept] - costs[best]
        self._last = pose
        return place

    def _emission(self, pose: Pose, candidates: Candidates, turns_deg: Floats) -> Floats:
        """Misfit of offset and heading, weighed by how much of them is new evidence."""
        std_m = math.hypot(position_std_m(pose, None), LINE_STD_M)
        heading_std_deg = math.hypot(pose.heading_std_deg or 0.0, HEADING_STD_DEG)
        costs = _huber(np.abs(candidates.offsets_m) / std_m)
        stands = pose.speed_mps is not None and abs(pose.speed_mps) < STANDING_MPS
        if self._last is None or not stands:
            costs = costs + _huber(turns_deg / heading_std_deg)  # of one that stands it is old
        return _news(self._last, pose) * costs

    def _first_totals(self, candidates: Candidates) -> Floats:
        alongs_m, length_m = candidates.alongs_m, self._route.length_m
        if not self._route.loop:
            return alongs_m
        return np.where(alongs_m > length_m - BEFORE_START_M, alongs_m - length_m, alongs_m)

    def _moves(self, last: Pose, pose: Pose, expected_m: float | None) -> "_Moves":
        travelled_m = travelled_between_m(last, pose)
        if expected_m is None:
            slack_m = MOTION_SLACK_M + MOTION_SLACK_SHARE * abs(travelled_m)
            return _Moves(travelled_m, travelled_m, slack_m, travelled_m, 0.0)
        least_m, most_m = sorted((travelled_m, expected_m))
        slack_m = SELDOM_SLACK_M + MOTION_SLACK_SHARE * most_m
        return _Moves(least_m, most_m, slack_m, expected_m, UNLIKE_COST)

    def _transition(self, moves: "_Moves", candidates: Candidates) -> tuple[Floats, Floats]:
        """Distance and cost of reaching every candidate from the best of the earlier places."""
        middle_m = (moves.least_m + moves.most_m) / 2.0
        # rows: earlier places, columns: candidates
        advances_m = candidates.alongs_m[None, :] - self._totals_m[:, None]
        surplus_m = advances_m - middle_m
        if self._route.loop:
            length_m = self._route.length_m
            surplus_m = (surplus_m + length_m / 2.0) % length_m - length_m / 2.0
        half_m = (moves.most_m - moves.least_m) / 2.0
        outside_m = np.abs(surplus_m)
        if half_m > 0.0:
            outside_m = np.maximum(outside_m - half_m, 0.0)
        misfit = outside_m / moves.slack_m
        if moves.unlike_cost > 0.0 or abs(moves.likely_m) < STANDING_M:
            # of reports, and of a stand, small misfits are noise
            misfit = np.minimum(misfit, misfit**2)
        costs = self._costs[:, None] + misfit / (1.0 + misfit / JUMP_COST)
        if moves.unlike_cost > 0.0:
            unlike_m = np.abs(middle_m + surplus_m - moves.likely_m)
            costs += moves.unlike_cost * unlike_m / (moves.slack_m + moves.most_m)
        earlier = np.argmin(costs, axis=0)
        column = np.arange(len(earlier))
        totals_m = self._totals_m[earlier] + middle_m + surplus_m[earlier, column]
        return totals_m, costs[earlier, column]

    def _place(
        self,
        pose: Pose,
        candidates: Candidates,
        totals_m: Floats,
        turns_deg: Floats,
        best: int,
    ) -> Place:
        heading_deg = float(candidates.headings_deg[best])
        return Place(
            float(totals_m[best]),
            float(candidates.offsets_m[best]),
            position_std_m(pose, heading_deg),
            position_std_m(pose, heading_deg + 90.0),
            float(turns_deg[best]),
        )


def _news(last: Pose | None, pose: Pose) -> float:
    """How much a pose tells that the last one did not, 0 to 1.

    All after some seconds; or the share of variance that has gone, as a fix takes away what dead
    reckoning did not know.
    """
    if last is None:
        return 1.0
    elapsed = (pose.t_ns - last.t_ns) * 1e-9 / CORRELATION_S
    before_m, now_m = (math.hypot(position_std_m(one, None), LINE_STD_M) for one in (last, pose))
    return min(max(elapsed, 1.0 - (now_m / before_m) ** 2), 1.0)


def _huber(sigmas: Floats) -> Floats:
    """Negative log likelihood of a misfit in sigmas, forgiving to outliers."""
    squared = np.minimum(sigmas, OUTLIER)
    return np.asarray(squared * (sigmas - 0.5 * squared))


def _turns_deg(pose: Pose, candidates: Candidates) -> Floats:
    """Between the vehicle's heading and the line's; 0 where the vehicle's is not known well."""
    uncertain = (pose.heading_std_deg or 0.0) > STEADY_HEADING_STD_DEG
    if pose.heading_deg is None or uncertain:
        return np.zeros(len(candidates.alongs_m))
    turns_deg = (candidates.headings_deg - pose.heading_deg + 180.0) % 360.0 - 180.0
    return np.asarray(np.abs(turns_deg))


def travelled_between_m(last: Pose, pose: Pose) -> float:
    """How far a vehicle went between two poses, negative in reverse.

    From the distance that only grows; where fusion has started anew, from speed and time.
    """
    speed_mps = pose.speed_mps or 0.0
    moved_m = pose.distance_m - last.distance_m
    if moved_m < 0.0:
        moved_m = abs(speed_mps) * (pose.t_ns - last.t_ns) * 1e-9
    return math.copysign(moved_m, speed_mps)


def position_std_m(pose: Pose, heading_deg: float | None) -> float:
    """One sigma of a pose's position along a heading, or the mean of both axes without one."""
    if pose.east_std_m is None or pose.north_std_m is None:
        return UNKNOWN_STD_M
    east_m2, north_m2 = pose.east_std_m**2, pose.north_std_m**2
    if heading_deg is None:
        return math.sqrt((east_m2 + north_m2) / 2.0)
    east, north = math.sin(math.radians(heading_deg)), math.cos(math.radians(heading_deg))
    crossed_m2 = 2.0 * east * north * (pose.east_north_cov_m2 or 0.0)
    return math.sqrt(max(east**2 * east_m2 + north**2 * north_m2 + crossed_m2, 0.0))
