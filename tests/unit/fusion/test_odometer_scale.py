"""What is learned of wheels and gyro, what leaves it alone, and what makes it be learned anew."""

from collections.abc import Callable

import msgspec
import numpy as np
import pytest

from builders import about, at, gyro, only, run_core
from faults import tunnel, wheels_read
from unit.fusion.drives import (
    Motion,
    Sensors,
    messages_of,
    noisy,
    seconds_of,
    stop_and_go,
    truth_of,
    winding,
)
from wayline.agreement import FORGOTTEN_AFTER_NS, Agreement, lasted_s, rejected
from wayline.messages import FusionStatus, GpsFix, Gyro, Message, Pose
from wayline.tuning import Tuning
from wayline_fusion.core import FusionCore
from wayline_fusion.filter.horizontal import HorizontalFilter
from wayline_fusion.filter.measurements import gps_speed, odometer
from wayline_fusion.filter.states import SIZE, States

TUNING = Tuning()
REAL = Sensors(gps_noise_m=0.5)


def drive(
    motion: Motion, duration_s: float, sensors: Sensors = REAL, seed: int = 1
) -> list[Message]:
    """With wheels and Doppler as noisy as the configuration has them."""
    exact = messages_of(motion, truth_of(motion, duration_s), sensors, seed)
    return list(noisy(exact, TUNING.odometer_std_mps, TUNING.gps_speed_std_mps, seed))


def statuses_of(messages: list[Message]) -> list[FusionStatus]:
    statuses: list[FusionStatus] = only(run_core(FusionCore(TUNING), messages), FusionStatus)
    return statuses


def rejected_by(statuses: list[FusionStatus], sensor: str) -> list[tuple[int, str | None]]:
    """Instants and reasons."""
    verdicts = [v for status in statuses for v in status.verdicts]
    return [(v.t_ns, v.reason) for v in verdicts if v.sensor == sensor and not v.accepted]


def hard_stop_and_go(seconds: float) -> tuple[float, float]:
    """Every 30 s: up to 15 m/s in 5 s, and down again as fast as tyres can."""
    moving_s = max(seconds % 30.0 - 5.0, 0.0)
    return max(min(3.0 * moving_s, 15.0, 9.0 * (20.0 - moving_s)), 0.0), 0.0


@pytest.mark.parametrize("motion", [stop_and_go, hard_stop_and_go])
def test_without_gps_starts_and_stops_teach_the_wheels_nothing(motion: Motion) -> None:
    """Ten of each: only what is known of speed besides wheels can tell their scale."""
    sensors = REAL._replace(odometer_scale=0.96)
    wheels_alone = [m for m in drive(motion, 330.0, sensors) if not isinstance(m, GpsFix)]
    first, *_, last = statuses_of(wheels_alone)
    assert last.odometer_scale == first.odometer_scale == 1.0
    assert last.odometer_scale_std == pytest.approx(first.odometer_scale_std, rel=0.01)


def test_gps_alone_teaches_the_wheels_nothing_either() -> None:
    """What Doppler and a guessed acceleration disagree in is no scale of wheels that are silent."""
    gps_alone: list[Message] = [m for m in drive(hard_stop_and_go, 200.0) if isinstance(m, GpsFix)]
    first, *_, last = statuses_of(gps_alone)
    assert last.odometer_scale == first.odometer_scale == 1.0
    assert last.odometer_scale_std == pytest.approx(first.odometer_scale_std, rel=0.01)


def test_wheels_of_another_size_are_learned_anew_while_doppler_goes_on() -> None:
    """Rejected for ten seconds, then taken by the scale that Doppler gives them."""
    messages = wheels_read((60.0, 999.0), 1.15)(drive(winding, 120.0), at(0.0))
    statuses = statuses_of(messages)
    anew = [t_ns for t_ns, reason in rejected_by(statuses, "odometer") if "anew" in (reason or "")]
    assert [seconds_of(t_ns) for t_ns in anew] == [about(70.0, 0.5)]
    assert not rejected_by(statuses, "gps_speed")
    last = statuses[-1]
    assert last.odometer_scale is not None
    assert last.odometer_scale_std is not None
    assert abs(last.odometer_scale - 1.0 / 1.15) < 3.0 * last.odometer_scale_std


def test_wheels_that_doppler_contradicted_are_believed_again_in_a_tunnel() -> None:
    """Nothing contradicts them there, and without them no braking would be noticed."""
    sensors = REAL._replace(outage=(65.0, 120.0))
    messages = wheels_read((63.0, 999.0), 2.5)(drive(stop_and_go, 120.0, sensors), at(0.0))
    rejected = [t_ns for t_ns, _ in rejected_by(statuses_of(messages), "odometer")]
    assert any(at(64.0) < t_ns < at(65.0) for t_ns in rejected)
    assert not any(at(70.0) < t_ns < at(73.0) for t_ns in rejected)


def test_many_wheel_speeds_a_second_tell_no_more_than_ten() -> None:
    """Their errors last for longer than a hundredth of a second."""
    stds_mps = []
    for rate_hz in (10, 100):
        messages = drive(winding, 90.0, REAL._replace(odometer_hz=rate_hz))
        poses: list[Pose] = only(run_core(FusionCore(TUNING), messages), Pose)
        stds_mps.append(poses[-1].speed_std_mps or 0.0)
    assert stds_mps[1] > 0.8 * stds_mps[0] > 0.0


def test_starts_and_stops_in_a_tunnel_leave_the_scale_as_it_was_learned() -> None:
    sensors = REAL._replace(odometer_scale=0.96, outage=(150.0, 300.0))
    statuses = statuses_of(drive(hard_stop_and_go, 300.0, sensors))
    before = next(status for status in statuses if status.t_ns >= at(150.0))
    assert before.odometer_scale is not None
    assert abs(before.odometer_scale - 0.96) < 0.005
    assert statuses[-1].odometer_scale == about(before.odometer_scale, 1e-5)
    assert statuses[-1].odometer_scale_std == pytest.approx(before.odometer_scale_std, rel=0.3)


@pytest.mark.parametrize("motion", [stop_and_go, hard_stop_and_go])
@pytest.mark.parametrize("scale", [0.96, 1.04])
def test_in_stop_and_go_gps_teaches_the_scale(motion: Motion, scale: float) -> None:
    """Wherever it starts from, and as well as it says."""
    last = statuses_of(drive(motion, 250.0, REAL._replace(odometer_scale=scale)))[-1]
    assert last.odometer_scale is not None
    assert last.odometer_scale_std is not None
    assert last.odometer_scale_std < 0.003
    assert abs(last.odometer_scale - scale) < 3.0 * last.odometer_scale_std


@pytest.mark.parametrize("wheels_hz", [5, 10])
def test_starting_and_stopping_itself_teaches_no_scale(wheels_hz: int) -> None:
    """By exact sensors the scale is found once and stays, however slowly a start is believed."""
    sensors = REAL._replace(odometer_scale=0.96, odometer_hz=wheels_hz)
    exact = list(messages_of(stop_and_go, truth_of(stop_and_go, 200.0), sensors))
    scales = [s.odometer_scale or 0.0 for s in statuses_of(exact) if s.t_ns > at(35.0)]
    assert np.abs(np.array(scales) - 0.96).max() < 0.0008


def test_one_wrong_speed_on_either_side_of_a_tunnel_leaves_the_scale_alone() -> None:
    """A minute apart, with none between them, they are not a minute of wrong speeds."""
    wrong_ns = at(100.0), at(161.0)

    def faulty(message: Message) -> Message:
        if isinstance(message, GpsFix) and message.t_ns in wrong_ns:
            return msgspec.structs.replace(message, speed_mps=(message.speed_mps or 0.0) + 4.0)
        return message

    statuses = statuses_of(
        [faulty(m) for m in tunnel((101.0, 161.0))(drive(winding, 180.0), at(0.0))]
    )
    assert [t_ns for t_ns, _ in rejected_by(statuses, "gps_speed")] == [*wrong_ns]
    assert not rejected_by(statuses, "odometer")
    after_tunnel = next(status for status in statuses if status.t_ns >= at(162.0))
    assert after_tunnel.odometer_scale == about(1.0, 0.005)
    assert (after_tunnel.odometer_scale_std or 1.0) < 0.005


def shaken(*spans: tuple[float, float]) -> Callable[[Message], Message]:
    """Somebody gets in or out: the gyro of a vehicle that stands reads a turn."""

    def fault(message: Message) -> Message:
        seconds = seconds_of(message.t_ns)
        if isinstance(message, Gyro) and any(start <= seconds < end for start, end in spans):
            return gyro(seconds, (message.yaw_rate_degps or 0.0) + 1.5)
        return message

    return fault


def test_a_bias_refused_before_one_start_is_not_believed_at_the_next_stop() -> None:
    """Half a minute of driving lies between; standing on it would be two seconds' refusal."""
    shake = shaken((89.0, 90.3), (121.0, 122.5))
    messages = drive(stop_and_go, 128.0, REAL._replace(gyro_bias_degps=0.4))
    statuses = statuses_of([shake(message) for message in messages])
    refused_s = [seconds_of(t_ns) for t_ns, _ in rejected_by(statuses, "standstill_gyro")]
    assert min(refused_s) < 90.0
    assert max(refused_s) > 121.0
    assert not [why for _, why in rejected_by(statuses, "standstill_gyro") if "anew" in (why or "")]
    assert statuses[-1].gyro_bias_degps == about(0.4, 0.05)


def test_a_bias_that_stays_at_rest_is_believed() -> None:
    """The same shaking without a drive between: the gyro is another one."""
    messages = drive(stop_and_go, 130.0, REAL._replace(gyro_bias_degps=0.4))
    shake = shaken((122.0, 130.0))
    statuses = statuses_of([shake(message) for message in messages])
    assert [why for _, why in rejected_by(statuses, "standstill_gyro") if "anew" in (why or "")]
    assert statuses[-1].gyro_bias_degps == about(1.9, 0.1)


def test_a_streak_lasts_from_the_first_rejection_to_now() -> None:
    second_ns = 1_000_000_000
    streak = rejected(rejected(None, 5 * second_ns), 8 * second_ns)
    assert lasted_s(streak, 9 * second_ns) == about(4.0)
    assert lasted_s(None, 9 * second_ns) == 0.0


def test_a_streak_ends_with_a_silence() -> None:
    """What comes after it begins another one."""
    streak = Agreement(0, 0, 3_000_000_000)
    late_ns = streak.last_ns + FORGOTTEN_AFTER_NS + 1
    assert lasted_s(streak, late_ns) == 0.0
    assert rejected(streak, late_ns) == Agreement(late_ns, late_ns, late_ns)
    assert lasted_s(streak, late_ns - 1) > 12.0


def test_considering_a_state_counts_its_doubt_and_leaves_it() -> None:
    """The covariance is that of any gain with the state's row 0 (Joseph's form)."""
    kalman = HorizontalFilter(TUNING)
    kalman.x[States.WHEEL_SPEED] = 10.0
    for speed_mps in (10.1, 9.9, 10.2):  # so that speed and scale are correlated
        kalman.correct(gps_speed(kalman.x, speed_mps, 0.1))
    x, P = kalman.x.copy(), kalman.P.copy()  # noqa: N806 - the letter of the papers
    measurement = odometer(x, 9.0, 0.08)
    H, R = measurement.H, measurement.R  # noqa: N806
    K = P @ H.T @ np.linalg.inv(H @ P @ H.T + R)  # noqa: N806
    K[States.ODOMETER_SCALE] = 0.0
    left = np.eye(SIZE) - K @ H
    kalman.consider(measurement, States.ODOMETER_SCALE)
    assert kalman.x == pytest.approx(x + K @ measurement.y)
    assert np.allclose(kalman.P, left @ P @ left.T + K @ R @ K.T)
    assert abs(P[States.WHEEL_SPEED, States.ODOMETER_SCALE]) > 1e-3
