"""Pure: where along its route a vehicle is: the matcher on a network that is one route."""

import math
from typing import NamedTuple

from wayline.matching.matcher import Matcher
from wayline.matching.network import Sight
from wayline.matching.transition import Moves
from wayline.messages import Pose
from wayline.route import Route
from wayline_eta.route_network import RouteNetwork

STANDING_MPS = 0.5
UNKNOWN_STD_M = 5.0


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


class PlaceTracker:
    """The likeliest place of one vehicle on one route."""

    def __init__(self, route: Route) -> None:
        self._network = RouteNetwork(route)
        self._matcher = Matcher(self._network, advances=self._network.advances_m)
        self._last: Pose | None = None

    @property
    def is_circular(self) -> bool:
        """Whether an open route ends where it begins."""
        return self._network.is_circular

    def set_out(self, pose: Pose) -> None:
        """Begin at the start, wherever else the pose might be."""
        start = self._network.start
        lat_deg, lon_deg = pose.lat_deg, pose.lon_deg
        self._matcher.set_out(_sight(pose, lat_deg or 0.0, lon_deg or 0.0), start)
        self._last = pose

    def observe(
        self, pose: Pose, lat_deg: float, lon_deg: float, expected_m: float | None = None
    ) -> Place:
        """Take the next pose with its position in degrees, and say where the vehicle is.

        Where nobody knows the way since the last one, `expected_m` is how far along the route it
        is expected to have come; then all between that and the straight way is as likely.
        """
        travelled_m = travelled_between_m(self._last or pose, pose)
        if expected_m is None:
            moves = Moves.measured(travelled_m)
        else:
            moves = Moves.between(travelled_m, expected_m)
        found = self._matcher.observe(_sight(pose, lat_deg, lon_deg), moves)
        assert found is not None  # noqa: S101  # a route is always near
        self._last = pose
        candidate, heading_deg = found.candidate, found.candidate.heading_deg
        return Place(
            found.total_m,
            candidate.offset_m,
            position_std_m(pose, heading_deg),
            position_std_m(pose, heading_deg + 90.0),
            found.turn_deg,
        )


def _sight(pose: Pose, lat_deg: float, lon_deg: float) -> Sight:
    return Sight(
        pose.t_ns,
        lat_deg,
        lon_deg,
        position_std_m(pose, None),
        pose.heading_deg,
        pose.heading_std_deg or 0.0,
        stands=pose.speed_mps is not None and abs(pose.speed_mps) < STANDING_MPS,
    )


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
