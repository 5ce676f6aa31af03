"""The fusion core on closed-form drives: what it must find, and when it must say it is unsure."""

import math

import pytest

from builders import about, at, fix, gyro, odometer, only, run_core
from unit.fusion.drives import (
    ORIGIN,
    Motion,
    Sensors,
    Truth,
    circle,
    error_m,
    messages_of,
    seconds_of,
    town,
    truth_of,
)
from wayline.messages import Barometer, FusionStatus, GpsFix, Message, Pose
from wayline.tuning import Tuning
from wayline_fusion.core import FusionCore


def drive(
    motion: Motion, duration_s: float, sensors: Sensors
) -> tuple[list[Truth], list[Pose], list[FusionStatus]]:
    truths = truth_of(motion, duration_s)
    outputs = run_core(FusionCore(Tuning()), messages_of(motion, truths, sensors))
    return truths, only(outputs, Pose), only(outputs, FusionStatus)


def position_std_m(pose: Pose) -> float:
    return math.hypot(pose.east_std_m or 0.0, pose.north_std_m or 0.0)


def test_poses_lie_on_the_grid_ten_times_a_second() -> None:
    _, poses, _ = drive(circle, 5.0, Sensors())
    assert [pose.t_ns for pose in poses] == [at(0.1 * step) for step in range(50)]


def test_perfect_sensors_on_a_circle_give_the_circle() -> None:
    """The midpoint heading keeps the chord of every step."""
    truths, poses, _ = drive(circle, 120.0, Sensors())
    assert max(error_m(pose, truths) for pose in poses[100:]) < 0.3


@pytest.mark.parametrize(
    ("field", "sensors", "value", "tolerance"),
    [
        ("gyro_bias_degps", Sensors(gyro_bias_degps=0.8, gps_noise_m=1.5), 0.8, 0.02),
        ("odometer_scale", Sensors(odometer_scale=0.96, gps_noise_m=1.5), 0.96, 0.005),
        ("gyro_scale", Sensors(gyro_scale=1.03, gps_noise_m=1.5), 1.03, 0.01),
    ],
)
def test_sensor_errors_are_learned_within_their_stds(
    field: str, sensors: Sensors, value: float, tolerance: float
) -> None:
    _, _, statuses = drive(town, 400.0, sensors)
    learned, std_field = getattr(statuses[-1], field), field.replace("_degps", "_std_degps")
    std = getattr(statuses[-1], std_field if "degps" in field else f"{field}_std")
    assert learned == pytest.approx(value, abs=tolerance)
    assert abs(learned - value) < 3.0 * std
    assert statuses[-1].calibration == "calibrated"


def test_an_outage_is_dead_reckoned_with_growing_stds() -> None:
    """One minute at 12 m/s after five minutes of learning: under 1 % of the distance."""
    sensors = Sensors(0.5, 1.02, 0.97, gps_noise_m=1.0, outage=(300.0, 360.0))
    truths, poses, statuses = drive(town, 365.0, sensors)
    before, end = poses[2999], poses[3599]
    assert before.mode == "fused"
    assert end.mode == "dead_reckoning"
    assert error_m(end, truths) < 7.0
    assert position_std_m(end) > 2.0 * position_std_m(before)
    assert error_m(end, truths) < 3.0 * position_std_m(end)
    assert statuses[-1].outage_s < 2.0
    assert poses[-1].mode == "fused"


def test_late_fixes_are_applied_at_their_own_time() -> None:
    """At 15 m/s a fix that is 0.5 s old would pull the pose 7 m back if taken as new."""
    prompt = drive(circle, 60.0, Sensors())[1][-1]
    late = drive(circle, 60.0, Sensors(latency_s=0.5))[1][-1]
    assert late.lat_deg == pytest.approx(prompt.lat_deg, abs=2e-6)
    assert late.lon_deg == pytest.approx(prompt.lon_deg, abs=4e-6)


def test_standing_still_holds_heading_and_learns_the_bias() -> None:
    def stop(seconds: float) -> tuple[float, float]:
        return (10.0, 0.0) if seconds < 30.0 else (0.0, 0.0)

    _, poses, statuses = drive(stop, 90.0, Sensors(gyro_bias_degps=0.4, outage=(32.0, 99.0)))
    assert poses[400].heading_deg == about(poses[-1].heading_deg or 0.0, 1e-3)
    assert poses[-1].speed_mps == about(0.0, 0.02)
    assert statuses[-1].gyro_bias_degps == about(0.4, 0.01)


def test_one_displaced_fix_is_rejected_and_said_so() -> None:
    truths = truth_of(town, 200.0)
    messages = list(messages_of(town, truths, Sensors(gps_noise_m=1.0)))
    clean = only(run_core(FusionCore(Tuning()), messages), Pose)[-1]
    place = next(
        index
        for index, message in enumerate(messages)
        if isinstance(message, GpsFix) and message.t_ns == at(195)
    )
    north_m = truths[19_500].north_m + 200.0
    lat_deg, lon_deg = ORIGIN.to_geodetic(truths[19_500].east_m, north_m)
    messages[place] = fix(195.0, lat_deg, lon_deg, h_std_m=1.0)
    outputs = run_core(FusionCore(Tuning()), messages)
    verdicts = [v for status in only(outputs, FusionStatus) for v in status.verdicts]
    (rejected,) = [v for v in verdicts if not v.accepted and v.t_ns == at(195)]
    assert rejected.sensor == "gps_position"
    assert rejected.nis > rejected.threshold
    assert rejected.reason
    assert only(outputs, Pose)[-1].lat_deg == pytest.approx(clean.lat_deg, abs=2e-6)


def test_fixes_that_stay_displaced_are_believed_after_as_long_as_the_others_were() -> None:
    truths = truth_of(circle, 130.0)
    displaced_m = 300.0
    messages: list[Message] = []
    for message in messages_of(circle, truths, Sensors()):
        if isinstance(message, GpsFix) and message.t_ns > at(60):
            truth = truths[round(seconds_of(message.t_ns) * 100)]
            lat_deg, lon_deg = ORIGIN.to_geodetic(truth.east_m + displaced_m, truth.north_m)
            messages.append(fix(seconds_of(message.t_ns), lat_deg, lon_deg, h_std_m=1.0))
        else:
            messages.append(message)
    last = only(run_core(FusionCore(Tuning()), messages), Pose)[-1]
    assert error_m(last, truths) == about(displaced_m, 3.0)


def test_before_the_first_fix_nothing_is_invented() -> None:
    messages = [
        m for step in range(200) for m in (gyro(step * 0.05, 0.0), odometer(step * 0.05, 8.0))
    ]
    last = only(run_core(FusionCore(Tuning()), messages), Pose)[-1]
    assert last.mode == "starting"
    assert (last.lat_deg, last.heading_deg, last.alt_m, last.grade_pct) == (None,) * 4
    assert last.speed_mps == about(8.0, 0.5)
    assert last.distance_m == about(80.0, 3.0)


def test_invalid_fixes_are_not_used() -> None:
    messages = [GpsFix(t_ns=at(s), valid=False, speed_mps=0.04) for s in range(10)]
    outputs = run_core(FusionCore(Tuning()), messages)
    assert {pose.mode for pose in only(outputs, Pose)} == {"starting"}


def test_without_can_a_pose_carries_its_fixes_own_instant() -> None:
    messages = [
        fix(0.3 + second, *ORIGIN.to_geodetic(0.0, 10.0 * second), speed_mps=10.0, course_deg=0.0)
        for second in range(20)
    ]
    poses = only(run_core(FusionCore(Tuning()), messages), Pose)
    assert [pose.t_ns for pose in poses] == [message.t_ns for message in messages]
    assert {pose.mode for pose in poses[2:]} == {"gps"}
    assert poses[-1].speed_mps == about(10.0, 0.1)


def test_without_can_and_fixes_a_pose_comes_once_a_second() -> None:
    start = [fix(0.3 + s, *ORIGIN.to_geodetic(0.0, 10.0 * s), speed_mps=10.0, course_deg=0.0)
             for s in range(10)]  # fmt: skip
    silent = [GpsFix(t_ns=at(0.3 + s), valid=False) for s in range(10, 20)]
    poses = only(run_core(FusionCore(Tuning()), [*start, *silent]), Pose)
    assert [pose.t_ns for pose in poses[10:]] == [at(s) for s in range(11, 20)]
    assert poses[-1].mode == "dead_reckoning"


def test_a_receiver_without_speed_and_course_is_followed_by_its_displacement() -> None:
    messages = [fix(s, *ORIGIN.to_geodetic(8.0 * s, 0.0)) for s in range(60)]
    last = only(run_core(FusionCore(Tuning()), messages), Pose)[-1]
    assert last.heading_deg == about(90.0, 3.0)
    assert last.speed_mps == about(8.0, 0.5)


def test_grade_follows_altitude_over_distance() -> None:
    """5 % uphill at 15 m/s: 0.75 m/s; positive uphill in the direction of travel."""
    truths = truth_of(lambda _: (15.0, 0.0), 180.0)
    messages = list(messages_of(lambda _: (15.0, 0.0), truths, Sensors()))
    climbing = [
        fix(seconds_of(m.t_ns), m.lat_deg or 0.0, m.lon_deg or 0.0, speed_mps=15.0,
            course_deg=0.0, alt_m=100.0 + 0.75 * seconds_of(m.t_ns), v_std_m=3.0)
        if isinstance(m, GpsFix) else m
        for m in messages
    ]  # fmt: skip
    last = only(run_core(FusionCore(Tuning()), climbing), Pose)[-1]
    assert last.grade_pct == about(5.0, 0.3)
    assert last.alt_m == about(100.0 + 0.75 * 179.9, 2.0)


@pytest.mark.parametrize(("step_pa", "used"), [(0.1, True), (50.0, True), (1000.0, False)])
def test_a_coarse_barometer_says_nothing_of_the_road(step_pa: float, used: bool) -> None:
    """1 kPa is 85 m of altitude: whole-kPa barometers are left out, fine ones are not."""
    core = FusionCore(Tuning(vertical_sensors=("barometer", "gps")))
    messages: list[Message] = [fix(0.0, 56.0, 10.0, alt_m=100.0)]
    for second in range(1, 60):
        pressure_pa = round((100_000.0 - 7.3 * second) / step_pa) * step_pa
        messages.append(odometer(second, 10.0))
        messages.append(Barometer(t_ns=at(second), pressure_pa=pressure_pa))
    status = only(run_core(core, messages), FusionStatus)[-1]
    assert status.baro_bias_std_m is not None
    assert (status.baro_bias_std_m < 20.0) is used


def test_without_wheels_a_vehicle_goes_forward() -> None:
    """Noise around a standstill makes the speed negative; driving on must not be reversing."""

    def motion(seconds: float) -> tuple[float, float]:
        return (0.0 if 30.0 <= seconds < 60.0 else 10.0, 0.0)

    truths = truth_of(motion, 100.0)
    messages = [
        message
        for message in messages_of(motion, truths, Sensors(gps_noise_m=2.0))
        if message.topic != "odometer"
    ]
    poses = only(run_core(FusionCore(Tuning()), messages), Pose)
    assert min(pose.speed_mps for pose in poses[700:]) > 5.0
    assert poses[-1].heading_deg == about(0.0, 5.0) or poses[-1].heading_deg == about(360.0, 5.0)


def test_a_clock_set_right_by_years_starts_over_and_keeps_the_calibration() -> None:
    """And does so at once: nothing is integrated over the years."""
    truths = truth_of(town, 200.0)
    messages: list[Message] = list(messages_of(town, truths, Sensors(0.5, gps_noise_m=1.0)))
    years_s = 50.0 * 365.0 * 86400.0
    messages += [gyro(years_s, 0.5), odometer(years_s, 12.0), odometer(years_s + 1.0, 12.0)]
    outputs = run_core(FusionCore(Tuning()), messages)
    last = only(outputs, Pose)[-1]
    assert (last.mode, last.lat_deg, last.heading_deg) == ("starting", None, None)
    status = only(outputs, FusionStatus)[-1]
    assert status.gyro_bias_degps == about(0.5, 0.05)


def test_every_measurement_has_its_verdict_once_also_when_fixes_come_out_of_order() -> None:
    """A late fix sets newer ones back; they are applied again but not told again."""
    truths = truth_of(circle, 30.0)
    messages = list(messages_of(circle, truths, Sensors()))
    fixes = [index for index, message in enumerate(messages) if isinstance(message, GpsFix)]
    late = messages.pop(fixes[20])
    assert isinstance(late, GpsFix)
    newer = fix(20.5, *ORIGIN.to_geodetic(truths[2050].east_m, truths[2050].north_m), h_std_m=1.0)
    after = next(i for i, m in enumerate(messages) if m.t_ns > at(20.6))
    messages[after:after] = [newer, late]
    statuses = only(run_core(FusionCore(Tuning()), messages), FusionStatus)
    told = [(v.sensor, v.t_ns) for status in statuses for v in status.verdicts]
    assert len(told) == len(set(told))
    assert ("gps_position", late.t_ns) in told
    assert ("gps_position", newer.t_ns) in told
