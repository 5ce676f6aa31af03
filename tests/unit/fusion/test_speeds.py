"""Speed: hard braking, wheels that lock or spin, rest, and how well it is said to be known."""

from collections.abc import Iterable, Sequence

import numpy as np
import pytest

from builders import about, at, only, run_core
from faults import tunnel, wheels_read
from unit.fusion.drives import (
    Motion,
    Sensors,
    Truth,
    error_m,
    heading_error_deg,
    messages_of,
    noisy,
    seconds_of,
    speed_error_mps,
    stop_and_go,
    truth_at,
    truth_of,
    winding,
)
from wayline.messages import FusionStatus, GpsFix, Message, Odometer, Pose, Verdict
from wayline.tuning import Tuning
from wayline_fusion.core import FusionCore

TUNING = Tuning()
START_NS = at(0.0)
FAULT_S = 60.0
REAL = Sensors(gps_noise_m=0.5)


def emergency_stop(seconds: float) -> tuple[float, float]:
    """72 km/h to rest as fast as tyres can."""
    return (20.0 if seconds < FAULT_S else max(20.0 - 9.0 * (seconds - FAULT_S), 0.0)), 0.0


def motorway(seconds: float) -> tuple[float, float]:
    """30 m/s round bends that press passengers aside with 3 m/s2."""
    return 30.0, 5.7 * np.sin(seconds / 5.0)


def drive(motion: Motion, duration_s: float) -> tuple[list[Truth], list[Message]]:
    """With wheels and Doppler as noisy as the configuration has them."""
    truths = truth_of(motion, duration_s)
    exact = messages_of(motion, truths, REAL)
    return truths, list(noisy(exact, TUNING.odometer_std_mps, TUNING.gps_speed_std_mps))


def fixes_of(messages: Iterable[Message]) -> list[Message]:
    return [message for message in messages if isinstance(message, GpsFix)]


def run(messages: Sequence[Message]) -> tuple[list[Pose], list[Verdict]]:
    """Poses, and the measurements that were rejected."""
    outputs = run_core(FusionCore(TUNING), messages)
    verdicts = [v for status in only(outputs, FusionStatus) for v in status.verdicts]
    return only(outputs, Pose), [verdict for verdict in verdicts if not verdict.accepted]


def between(poses: list[Pose], from_s: float, to_s: float) -> list[Pose]:
    return [pose for pose in poses if at(from_s) <= pose.t_ns < at(to_s)]


def times_ns(rejected: list[Verdict], sensor: str) -> list[int]:
    return [verdict.t_ns for verdict in rejected if verdict.sensor == sensor]


def test_an_emergency_stop_is_believed_from_its_first_wheel_speed_on() -> None:
    """A filter that thinks of ordinary braking would reject them all."""
    truths, messages = drive(emergency_stop, 75.0)
    poses, rejected = run(messages)
    assert not times_ns(rejected, "odometer")
    assert not times_ns(rejected, "gps_speed")
    braking = between(poses, FAULT_S + 0.15, 75.0)
    assert max(speed_error_mps(pose, truths) for pose in braking) < 0.4
    assert max(error_m(pose, truths) for pose in braking) < 1.5


def test_an_emergency_stop_is_followed_on_gps_alone() -> None:
    truths, messages = drive(emergency_stop, 75.0)
    poses, rejected = run(fixes_of(messages))
    assert not times_ns(rejected, "gps_speed")
    braking = between(poses, FAULT_S, 75.0)
    assert max(speed_error_mps(pose, truths) for pose in braking) < 0.5
    assert max(error_m(pose, truths) for pose in braking) < 2.0


def test_wheels_that_spin_are_rejected_as_long_as_doppler_says_otherwise() -> None:
    """15 % too fast for 5 s."""
    truths, messages = drive(winding, 75.0)
    spinning = wheels_read((FAULT_S, FAULT_S + 5.0), 1.15)(messages, START_NS)
    poses, rejected = run(spinning)
    spun_ns = [
        m.t_ns for m in messages if isinstance(m, Odometer) and 60.0 <= seconds_of(m.t_ns) < 65.0
    ]
    assert times_ns(rejected, "odometer") == spun_ns
    assert max(error_m(pose, truths) for pose in between(poses, 60.0, 75.0)) < 2.0
    assert max(speed_error_mps(pose, truths) for pose in between(poses, 60.0, 75.0)) < 1.0


def test_where_nothing_says_otherwise_wheels_are_believed_again_soon() -> None:
    """Wheels 40 % too fast, in a tunnel: their speed is the only one there is."""
    truths, messages = drive(winding, 75.0)
    spinning = wheels_read((FAULT_S, 75.0), 1.4)(messages, START_NS)
    poses, rejected = run(tunnel((FAULT_S - 2.0, 75.0))(spinning, START_NS))
    first_ns, *_, last_ns = times_ns(rejected, "odometer")
    assert first_ns == at(FAULT_S)
    assert seconds_of(last_ns) == about(FAULT_S + TUNING.wheels_relock_after_s, 0.15)
    last = poses[-1]
    assert last.speed_mps == about(1.4 * truth_at(last.t_ns, truths).speed_mps, 0.4)


@pytest.mark.parametrize("with_gps", [True, False], ids=["gps", "tunnel"])
def test_wheels_that_lock_are_no_standstill(with_gps: bool) -> None:
    """From 15 m/s to nothing within a tenth of a second, for a second: no tyres can."""
    truths, messages = drive(winding, 65.0)
    locked = wheels_read((FAULT_S, FAULT_S + 1.0), 0.0)(messages, START_NS)
    poses, rejected = run(locked if with_gps else tunnel((58.0, 99.0))(locked, START_NS))
    assert len(times_ns(rejected, "odometer")) == 10
    assert max(speed_error_mps(pose, truths) for pose in between(poses, 60.0, 65.0)) < 0.8
    assert max(error_m(pose, truths) for pose in between(poses, 60.0, 65.0)) < 1.5


def test_who_brakes_comes_to_rest_and_does_not_turn_round() -> None:
    """The last fix before a tunnel tells of 2 m/s and hard braking; nothing tells of the rest."""

    def motion(seconds: float) -> tuple[float, float]:
        return (20.0 if seconds < FAULT_S else max(20.0 - 6.0 * (seconds - FAULT_S), 0.0)), 0.0

    truths, messages = drive(motion, 75.0)
    poses, _ = run(tunnel((FAULT_S + 3.5, 99.0))(fixes_of(messages), START_NS))
    unseen = between(poses, FAULT_S + 3.5, 75.0)
    assert len(unseen) >= 9
    assert {pose.speed_mps for pose in unseen} == {0.0}
    assert max(error_m(pose, truths) for pose in unseen) < 1.5
    assert unseen[-1].distance_m == unseen[0].distance_m


def test_on_gps_alone_a_stop_stays_at_rest() -> None:
    """Braking as on any day, and noise of speeds, which never is negative, at rest."""
    _, messages = drive(stop_and_go, 200.0)
    poses, _ = run(fixes_of(messages))
    assert min(pose.speed_mps or 0.0 for pose in poses) > -0.05


@pytest.mark.parametrize("motion", [winding, stop_and_go])
@pytest.mark.parametrize("with_can", [True, False], ids=["can", "gps alone"])
def test_speed_is_known_as_well_as_it_says(motion: Motion, with_can: bool) -> None:
    """68 % of a normal distribution lie within one sigma, 95 % within two."""
    truths, messages = drive(motion, 400.0)
    poses, _ = run(messages if with_can else fixes_of(messages))
    moving = [p for p in between(poses, 60.0, 400.0) if truth_at(p.t_ns, truths).speed_mps > 0.5]
    stds = np.array([speed_error_mps(p, truths) / (p.speed_std_mps or np.nan) for p in moving])
    assert 0.5 < np.mean(stds < 1.0) < 0.9
    assert np.mean(stds < 2.0) > 0.9


@pytest.mark.parametrize("wheels_hz", [1, 2, 10])
def test_distance_is_that_of_the_wheels(wheels_hz: int) -> None:
    """However hard the vehicle started and stopped between two of their speeds."""

    def motion(seconds: float) -> tuple[float, float]:
        return (
            min(4.0 * seconds, 20.0) if seconds < 20.0 else emergency_stop(seconds + 40.0)[0]
        ), 0.0

    messages = messages_of(motion, truth_of(motion, 40.0), Sensors(odometer_hz=wheels_hz))
    blind = [message for message in messages if not isinstance(message, GpsFix)]
    poses, _ = run(blind)
    wheels = [(seconds_of(m.t_ns), m.speed_mps) for m in blind if isinstance(m, Odometer)]
    seconds, speeds_mps = np.array(wheels).T
    assert poses[-1].distance_m == about(float(np.trapezoid(speeds_mps, seconds)), 0.05)


def test_at_speed_a_vehicle_without_a_gyro_turns_slowly() -> None:
    """Passengers bear some lateral acceleration: 4 s later the heading is still good for much."""
    stds_deg = {}
    for speed_mps in (4.0, 30.0):

        def motion(_: float, speed_mps: float = speed_mps) -> tuple[float, float]:
            return speed_mps, 0.0

        _, messages = drive(motion, 65.0)
        poses, _ = run(tunnel((FAULT_S, 99.0))(fixes_of(messages), START_NS))
        at_end = next(pose for pose in poses if pose.t_ns >= at(63.0))
        stds_deg[speed_mps] = at_end.heading_std_deg or 0.0
    as_configured_deg = TUNING.turn_noise_deg_per_sqrt_s * np.sqrt(4.0)
    assert stds_deg[4.0] == about(as_configured_deg, 2.0)
    assert stds_deg[30.0] < 0.4 * as_configured_deg


def test_bends_at_speed_are_followed_without_a_gyro() -> None:
    """What is left to a heading at speed is enough for the road."""
    truths, messages = drive(motorway, 120.0)
    poses, rejected = run(fixes_of(messages))
    assert not times_ns(rejected, "gps_course")
    assert max(heading_error_deg(pose, truths) for pose in between(poses, 20.0, 120.0)) < 1.0
