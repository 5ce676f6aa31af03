"""One vehicle on one route: when progress waits, and when it goes back."""

import msgspec
import pytest

from unit.eta.route_drives import SECOND_NS, Metres, poses, route_of
from wayline.messages import Pose
from wayline.tuning import Tuning
from wayline_eta.route_follower import RouteFollower

STRAIGHT: list[Metres] = [(0, 0), (3000, 0)]
UNSURE_M = 40.0


def told_m(follower: RouteFollower, pose: Pose) -> float:
    """Progress at a pose."""
    assert pose.lat_deg is not None
    assert pose.lon_deg is not None
    follower.observe(pose, pose.lat_deg, pose.lon_deg)
    progress = follower.progress(pose.t_ns)
    assert progress is not None
    return progress.distance_m


@pytest.mark.parametrize(("back_m", "stays"), [(90.0, True), (150.0, False)])
def test_a_fall_back_within_three_sigmas_is_waited_for(back_m: float, stays: bool) -> None:
    """Poses known to 40 m along the road: 90 m back is noise, 150 m back is the vehicle."""
    follower = RouteFollower(route_of(STRAIGHT), Tuning())
    [(first, _)] = poses(STRAIGHT, [0.0], start_m=1000.0)
    [(second, _)] = poses(STRAIGHT, [0.0], start_m=1000.0 - back_m)
    unsure = {"east_std_m": UNSURE_M, "north_std_m": UNSURE_M}
    assert told_m(follower, msgspec.structs.replace(first, **unsure)) == pytest.approx(1000.0)
    later = msgspec.structs.replace(second, t_ns=first.t_ns + SECOND_NS, **unsure)
    expected_m = 1000.0 if stays else 1000.0 - back_m
    assert told_m(follower, later) == pytest.approx(expected_m, abs=0.1)
