"""One vehicle on one route: when progress waits, and when it goes back."""

from typing import NamedTuple

import msgspec
import numpy as np
import pytest

from unit.eta.route_drives import SECOND_NS, Metres, poses, route_of
from wayline.messages import Pose
from wayline.tuning import Tuning
from wayline_eta.route_follower import RouteFollower
from wayline_eta.told_place import TAKEN_BACK_MPS

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


LONG: list[Metres] = [(0, 0), (8000, 0)]


class Told(NamedTuple):
    """Of one second, along the route."""

    true_m: float
    told_m: float
    std_m: float
    expected_m: float
    """What arrivals are predicted from."""


def seen_seldom(speeds_mps: list[float], every_s: int = 30) -> list[Told]:
    """What is told each second of a vehicle that reports its place and speed every so often."""
    follower = RouteFollower(route_of(LONG), Tuning())
    told: list[Told] = []
    for second, (pose, true_m) in enumerate(poses(LONG, speeds_mps)):
        if second % every_s == 0:
            assert pose.lat_deg is not None
            assert pose.lon_deg is not None
            follower.observe(pose, pose.lat_deg, pose.lon_deg, reported=True)
        progress, outlook = follower.progress(pose.t_ns), follower.outlook(pose.t_ns)
        if progress is not None and outlook is not None:
            told.append(Told(true_m, progress.distance_m, progress.distance_std_m, outlook.total_m))
    return told


def test_progress_waits_for_a_vehicle_that_stood_between_its_reports() -> None:
    """It stands from second 271 on, which its next report shows: 290 m short of what was told."""
    told = seen_seldom([10.0] * 271 + [0.0] * 40 + [10.0] * 200)
    told_m = np.array([each.told_m for each in told])
    true_m = np.array([each.true_m for each in told])
    assert np.diff(told_m).min() >= -TAKEN_BACK_MPS - 0.1
    assert np.abs(told_m - true_m).max() > 150.0
    assert abs(told_m[-1] - true_m[-1]) < 30.0


def test_while_progress_waits_std_and_arrivals_tell_where_the_vehicle_is() -> None:
    told = seen_seldom([10.0] * 271 + [0.0] * 40 + [10.0] * 200)
    waiting = [each for each in told if each.told_m > each.expected_m + 50.0]
    assert len(waiting) > 5
    assert all(abs(each.told_m - each.true_m) < 2.0 * each.std_m for each in waiting)
    assert all(abs(each.expected_m - each.true_m) < 50.0 for each in waiting[:5])


def test_progress_waits_within_noise_for_a_vehicle_that_drives() -> None:
    """Slower for half a minute, which its next report shows: 20 m short of what was told."""
    told_m = [each.told_m for each in seen_seldom([10.0] * 271 + [9.3] * 29 + [10.0] * 60)]
    assert np.diff(told_m).min() > -0.1


def test_progress_does_not_fall_back_where_poses_follow_reports() -> None:
    """It stands from second 271 on and is seen all the time from 300 on, 290 m behind."""
    follower = RouteFollower(route_of(LONG), Tuning())
    told: list[Told] = []
    for second, (pose, true_m) in enumerate(poses(LONG, [10.0] * 271 + [0.0] * 60)):
        assert pose.lat_deg is not None
        assert pose.lon_deg is not None
        if second % 30 == 0 or second >= 300:
            reported = second < 300
            follower.observe(pose, pose.lat_deg, pose.lon_deg, reported=reported)
        progress, outlook = follower.progress(pose.t_ns), follower.outlook(pose.t_ns)
        if progress is not None and outlook is not None:
            told.append(Told(true_m, progress.distance_m, progress.distance_std_m, outlook.total_m))
    behind_m = np.array([each.told_m - each.true_m for each in told])
    assert behind_m.max() > 150.0
    assert np.diff([each.told_m for each in told]).min() >= -TAKEN_BACK_MPS - 0.1
    waiting = [each for each in told[-60:] if each.told_m > each.expected_m + 1.0]
    assert len(waiting) > 5
    assert all(abs(each.told_m - each.true_m) < 1.1 * each.std_m for each in waiting[-5:])
    assert abs(behind_m[-1]) < 1.0
