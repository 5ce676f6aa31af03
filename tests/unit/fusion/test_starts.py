"""How a drive begins: in reverse, before its first fix, on GPS alone, anew after lost numbers."""

import math
from itertools import pairwise

import msgspec
import numpy as np
import pytest

from builders import about, at, only, run_core
from unit.fusion.drives import (
    ORIGIN,
    Motion,
    Sensors,
    Truth,
    circle,
    error_m,
    heading_error_deg,
    messages_of,
    seconds_of,
    speed_error_mps,
    stop_and_go,
    town,
    truth_at,
    truth_of,
)
from wayline.core import Record
from wayline.messages import FusionStatus, GpsFix, Gyro, Message, Odometer, Pose
from wayline.node import Node
from wayline.tuning import Tuning
from wayline_fusion.architectures.loose import Loose
from wayline_fusion.core import FusionCore


def out_of_a_garage(seconds: float) -> tuple[float, float]:
    """Back for 20 s, stand, then forward round the bend."""
    backward_mps = max(min(2.0 * seconds, 4.0, 2.0 * (20.0 - seconds)), 0.0)
    forward_mps = max(min(2.0 * (seconds - 25.0), 10.0), 0.0)
    return forward_mps - backward_mps, 0.9 * backward_mps + 0.4 * forward_mps


def drive(motion: Motion, duration_s: float, sensors: Sensors) -> tuple[list[Truth], list[Message]]:
    truths = truth_of(motion, duration_s)
    return truths, list(messages_of(motion, truths, sensors))


def poses_of(messages: list[Message]) -> list[Pose]:
    poses: list[Pose] = only(run_core(FusionCore(Tuning()), messages), Pose)
    return poses


@pytest.mark.parametrize("gps_noise_m", [0.0, 1.0])
def test_a_start_in_reverse_finds_the_heading_of_the_nose(gps_noise_m: float) -> None:
    """The course points out of the boot; the wheels say reverse."""
    truths, messages = drive(out_of_a_garage, 60.0, Sensors(gps_noise_m=gps_noise_m))
    poses = poses_of(messages)
    backing = [pose for pose in poses if at(10.0) <= pose.t_ns < at(17.0)]
    assert all((pose.speed_mps or 0.0) < -3.0 for pose in backing)
    assert max(heading_error_deg(pose, truths) for pose in backing) < 15.0
    assert heading_error_deg(poses[-1], truths) < 2.0
    assert error_m(poses[-1], truths) < 1.0 + 3.0 * gps_noise_m
    assert poses[-1].distance_m == about(truth_at(poses[-1].t_ns, truths).path_m, 3.0)


@pytest.mark.parametrize("motion", [stop_and_go, out_of_a_garage])
def test_the_position_follows_when_the_first_fix_comes_late(motion: Motion) -> None:
    """A minute without GPS: nothing is invented, and distance counts all the same."""
    truths, messages = drive(motion, 90.0, Sensors(outage=(0.0, 60.0)))
    poses = poses_of(messages)
    before = [pose for pose in poses if pose.t_ns < at(60.0)]
    assert {pose.mode for pose in before} == {"starting"}
    assert {pose.lat_deg for pose in before} == {None}
    assert before[-1].distance_m == pytest.approx(
        truth_at(before[-1].t_ns, truths).path_m, rel=0.03
    )
    after = [pose for pose in poses if pose.t_ns >= at(70.0)]
    assert {pose.mode for pose in after} == {"fused"}
    assert max(error_m(pose, truths) for pose in after) < 1.0
    assert max(heading_error_deg(pose, truths) for pose in after) < 3.0


def test_at_rest_everything_is_held() -> None:
    """Position within the noise of the fixes, heading to the digit, distance altogether."""
    _, messages = drive(stop_and_go, 130.0, Sensors(gyro_bias_degps=0.3, gps_noise_m=1.5))
    resting = [pose for pose in poses_of(messages) if at(122.0) <= pose.t_ns]
    headings_deg = [pose.heading_deg or 0.0 for pose in resting]
    assert np.ptp(np.unwrap(headings_deg, period=360.0)) < 0.05
    assert resting[-1].distance_m == about(resting[0].distance_m, 0.05)
    places_m = [ORIGIN.to_plane(pose.lat_deg or 0.0, pose.lon_deg or 0.0) for pose in resting]
    assert max(math.dist(a, b) for a, b in pairwise(places_m)) < 1.0
    assert {pose.mode for pose in resting} == {"fused"}


@pytest.mark.parametrize("motion", [circle, stop_and_go])
def test_on_gps_alone_the_pose_is_no_worse_than_its_fixes(motion: Motion) -> None:
    """papers/003's measures: position, speed and distance of the trip."""
    truths, messages = drive(motion, 300.0, Sensors(gps_noise_m=0.5))
    fixes = [message for message in messages if isinstance(message, GpsFix)]
    poses = [pose for pose in poses_of([*fixes]) if pose.t_ns >= at(60.0)]
    assert {pose.mode for pose in poses} == {"gps"}
    fix_places = {
        fix.t_ns: ORIGIN.to_plane(fix.lat_deg or 0.0, fix.lon_deg or 0.0) for fix in fixes
    }
    there = [(pose, truth_at(pose.t_ns, truths)) for pose in poses if pose.t_ns in fix_places]
    raw_m = [
        math.dist(fix_places[pose.t_ns], (truth.east_m, truth.north_m)) for pose, truth in there
    ]
    own_m = [error_m(pose, truths) for pose, _ in there]
    assert np.sqrt(np.mean(np.square(own_m))) < 1.1 * np.sqrt(np.mean(np.square(raw_m)))
    speeds_mps = [speed_error_mps(pose, truths) for pose, _ in there]
    assert np.sqrt(np.mean(np.square(speeds_mps))) < 0.15
    driven_m = poses[-1].distance_m - poses[0].distance_m
    true_m = there[-1][1].path_m - there[0][1].path_m
    assert driven_m == pytest.approx(true_m, rel=0.005)


@pytest.mark.parametrize("what", ["x", "P"])
def test_a_filter_that_loses_its_numbers_restarts_and_says_so(what: str) -> None:
    """The calibration stays, position and heading come back with the next fixes."""
    truths, messages = drive(town, 260.0, Sensors(gyro_bias_degps=0.5, gps_noise_m=1.0))
    core = FusionCore(Tuning())
    node = Node("fusion", core)
    outputs: list[Message] = []
    is_broken = False
    for message in messages:
        if not is_broken and message.t_ns >= at(240.05):
            assert isinstance(core._estimator, Loose)
            getattr(core._estimator.filter, what)[...] = math.nan
            is_broken = True
        outputs.extend(node.take(message, "test"))
    statuses = only(outputs, FusionStatus)
    (lost,) = [v for status in statuses for v in status.verdicts if v.sensor == "filter"]
    assert not lost.accepted
    assert "restarted" in (lost.reason or "")
    assert statuses[-1].gyro_bias_degps == about(0.5, 0.05)
    for pose in only(outputs, Pose):
        numbers = [v for v in msgspec.structs.astuple(pose) if isinstance(v, float)]
        assert np.isfinite(numbers).all()
    poses: list[Pose] = only(outputs, Pose)
    assert poses[-1].mode == "fused"
    assert error_m(poses[-1], truths) < 5.0
    assert heading_error_deg(poses[-1], truths) < 5.0
    assert (np.diff([pose.distance_m for pose in poses]) >= 0.0).all()
    assert seconds_of(lost.t_ns) == about(240.1, 0.2)


def test_only_the_gyro_is_missing() -> None:
    """Wheels and GPS: the heading comes from courses."""
    truths, messages = drive(town, 120.0, Sensors())
    poses = poses_of([message for message in messages if not isinstance(message, Gyro)])
    assert poses[-1].mode == "fused"
    assert error_m(poses[-1], truths) < 3.0
    assert poses[-1].yaw_rate_degps is None


def test_only_the_wheels_are_missing() -> None:
    truths, messages = drive(circle, 120.0, Sensors())
    poses = poses_of([message for message in messages if not isinstance(message, Odometer)])
    assert poses[-1].mode == "fused"
    assert max(error_m(pose, truths) for pose in poses[-300:]) < 2.0


def test_wheels_alone_do_not_tell_their_own_scale() -> None:
    """A minute of driving without GPS leaves the scale as unknown as it was."""
    _, messages = drive(circle, 60.0, Sensors(outage=(0.0, 60.0)))
    statuses = only(run_core(FusionCore(Tuning()), messages), FusionStatus)
    assert statuses[-1].odometer_scale == about(1.0, 0.005)
    assert statuses[-1].odometer_scale_std > 0.95 * statuses[0].odometer_scale_std


def test_without_wheels_hard_braking_is_followed_from_the_second_fix_on() -> None:
    def motion(seconds: float) -> tuple[float, float]:
        return (20.0 if seconds < 60.0 else max(20.0 - 8.0 * (seconds - 60.0), 4.0), 0.0)

    truths = truth_of(motion, 70.0)
    messages = [
        message
        for message in messages_of(motion, truths, Sensors(gps_noise_m=0.5))
        if message.topic == "gps_fix"
    ]
    poses = only(run_core(FusionCore(Tuning()), messages), Pose)
    after = next(pose for pose in poses if pose.t_ns >= at(62.9))
    assert after.speed_mps == about(4.0, 0.5)


def test_fixes_of_two_receivers_at_one_instant_tell_no_speed() -> None:
    """Neither tells one, and a moment between them there is none to divide the way by."""
    core, told = FusionCore(Tuning()), list[Message | Record]()
    for second in range(20):
        for source, off_deg in (("gps-ingest", 0.0), ("gps-ingest-2", 0.01)):
            lat_deg = ORIGIN.lat_deg + second * 1e-4 + off_deg
            fix = GpsFix(t_ns=at(second), valid=True, lat_deg=lat_deg, lon_deg=ORIGIN.lon_deg)
            told += core.handle(fix, source)
    assert {pose.t_ns for pose in only(told, Pose)} >= {at(second) for second in range(1, 20)}
