"""Motions with a formula for their place, and sensors that are exact, late, slow or coarse."""

import msgspec
import pytest

from builders import at, only, run_core
from unit.fusion.drives import (
    Motion,
    Sensors,
    circle,
    error_m,
    figure_eight,
    heading_error_deg,
    messages_of,
    speed_error_mps,
    spiral_down,
    stop_and_go,
    straight,
    truth_at,
    truth_of,
)
from wayline.geo import wrap_360
from wayline.messages import FusionStatus, GpsFix, Pose
from wayline.tuning import Tuning
from wayline_fusion.core import FusionCore

DURATION_S = 130.0
SETTLED_S = 50.0
"""Until then the heading is being found and the sensors are being calibrated."""
MOTIONS: list[Motion] = [straight, circle, figure_eight, stop_and_go, spiral_down]
OBD = Sensors(odometer_hz=2, speed_step_mps=1.0 / 3.6)
"""Speed as a car's diagnosis tells it: twice a second in steps of 1 km/h."""
WHERE = {
    "exact": Sensors(),
    "late": Sensors(latency_s=0.6),
    "coarse gyro": Sensors(rate_step_degps=0.25),
}


@pytest.mark.parametrize("motion", MOTIONS)
@pytest.mark.parametrize("sensors", WHERE.values(), ids=WHERE)
def test_the_pose_is_the_truth(motion: Motion, sensors: Sensors) -> None:
    """Late fixes cost nothing; a speed sampled at 10 Hz lags a hard start by a tenth second."""
    truths = truth_of(motion, DURATION_S)
    outputs = run_core(FusionCore(Tuning()), messages_of(motion, truths, sensors))
    poses = [pose for pose in only(outputs, Pose) if pose.t_ns >= at(SETTLED_S)]
    assert {pose.mode for pose in poses} == {"fused"}
    assert max(error_m(pose, truths) for pose in poses) < 0.8
    assert max(heading_error_deg(pose, truths) for pose in poses) < 0.5
    assert max(speed_error_mps(pose, truths) for pose in poses) < 0.4
    assert abs(poses[-1].distance_m - truth_at(poses[-1].t_ns, truths).path_m) < 0.5


@pytest.mark.parametrize("motion", MOTIONS)
def test_a_speed_twice_a_second_in_steps_is_enough(motion: Motion) -> None:
    """With late fixes and a coarse gyro besides; between speeds a start is not known."""
    sensors = OBD._replace(latency_s=0.6, rate_step_degps=0.25)
    truths = truth_of(motion, DURATION_S)
    outputs = run_core(FusionCore(Tuning()), messages_of(motion, truths, sensors))
    poses = [pose for pose in only(outputs, Pose) if pose.t_ns >= at(SETTLED_S)]
    assert max(error_m(pose, truths) for pose in poses) < 1.5
    assert max(heading_error_deg(pose, truths) for pose in poses) < 1.0
    assert abs(poses[-1].distance_m - truth_at(poses[-1].t_ns, truths).path_m) < 1.5


def test_pulling_away_is_believed_at_once_however_rarely_the_speed_comes() -> None:
    """Rest is known well, but a second later the vehicle may be under way."""
    truths = truth_of(stop_and_go, DURATION_S)
    outputs = run_core(FusionCore(Tuning()), messages_of(stop_and_go, truths, OBD))
    verdicts = [v for status in only(outputs, FusionStatus) for v in status.verdicts]
    assert not [v for v in verdicts if v.sensor == "odometer"]


def test_courses_that_are_all_off_do_not_turn_the_way() -> None:
    """An axle askew, or a receiver that cuts tenths of a degree: fixes tell in a few minutes."""
    truths = truth_of(straight, 600.0)
    messages = [
        msgspec.structs.replace(message, course_deg=wrap_360(message.course_deg - 0.1))
        if isinstance(message, GpsFix) and message.course_deg is not None
        else message
        for message in messages_of(straight, truths, Sensors())
    ]
    last = only(run_core(FusionCore(Tuning()), messages), Pose)[-1]
    assert heading_error_deg(last, truths) < 0.05


@pytest.mark.parametrize("motion", [figure_eight, spiral_down])
def test_without_gps_exact_sensors_follow_the_motion_for_a_minute(motion: Motion) -> None:
    """Dead reckoning only adds up: no formula of it may leak."""
    truths = truth_of(motion, DURATION_S)
    sensors = Sensors(outage=(65.0, 130.0))
    outputs = run_core(FusionCore(Tuning()), messages_of(motion, truths, sensors))
    last = only(outputs, Pose)[-1]
    assert last.mode == "dead_reckoning"
    assert error_m(last, truths) < 0.5
    assert heading_error_deg(last, truths) < 0.2
