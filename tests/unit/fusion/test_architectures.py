"""The papers' architectures on closed-form drives: what each knows, and what it must not."""

import math
from collections.abc import Iterable
from typing import get_args

import numpy as np
import pytest

from builders import about, at, only, run_core
from unit.fusion.drives import (
    ORIGIN,
    Motion,
    Sensors,
    circle,
    error_m,
    messages_of,
    straight,
    town,
    truth_of,
)
from wayline.messages import FusionStatus, GpsFix, Message, Pose
from wayline.tuning import ArchitectureName, Tuning
from wayline_fusion.architectures.choice import ARCHITECTURES
from wayline_fusion.core import FusionCore

COMPARED: tuple[ArchitectureName, ...] = ("uncoupled", "gps_only", "gps_only_modified")
GPS_ALONE: tuple[ArchitectureName, ...] = ("gps_only", "gps_only_modified")


def outputs_of(architecture: ArchitectureName, messages: Iterable[Message]) -> list[Message]:
    return run_core(FusionCore(Tuning(architecture=architecture)), messages)


def poses_of(architecture: ArchitectureName, messages: Iterable[Message]) -> list[Pose]:
    return only(outputs_of(architecture, messages), Pose)


def made(motion: Motion, duration_s: float, sensors: Sensors) -> list[Message]:
    return list(messages_of(motion, truth_of(motion, duration_s), sensors))


def pose_at(poses: list[Pose], seconds: float) -> Pose:
    (pose,) = [pose for pose in poses if pose.t_ns == at(seconds)]
    return pose


def place_m(pose: Pose) -> tuple[float, float]:
    assert pose.lat_deg is not None
    assert pose.lon_deg is not None
    return ORIGIN.to_plane(pose.lat_deg, pose.lon_deg)


def displaced(messages: list[Message], seconds: float, north_m: float, **fields: int) -> None:
    """Move the fix of one instant to the north."""
    for index, message in enumerate(messages):
        if isinstance(message, GpsFix) and message.t_ns == at(seconds):
            assert message.lat_deg is not None
            lat_deg = message.lat_deg + north_m / 111_000.0
            changed = {**{name: getattr(message, name) for name in message.__struct_fields__}}
            messages[index] = GpsFix(**{**changed, "lat_deg": lat_deg, **fields})


def test_every_name_in_the_tuning_is_built() -> None:
    assert set(ARCHITECTURES) == set(get_args(ArchitectureName))


@pytest.mark.parametrize("architecture", COMPARED)
def test_perfect_sensors_give_the_way_for_kilometres(architecture: ArchitectureName) -> None:
    """Through several local planes, one a kilometre."""
    truths = truth_of(straight, 150.0)
    poses = poses_of(architecture, messages_of(straight, truths, Sensors()))
    assert max(error_m(pose, truths) for pose in poses[20:]) < 0.3
    assert poses[-1].distance_m == pytest.approx(truths[-1].path_m, rel=0.01)


@pytest.mark.parametrize("architecture", COMPARED)
def test_late_fixes_are_applied_at_their_own_time(architecture: ArchitectureName) -> None:
    """Taken as new, fixes half a second old would pull the pose 10 m back."""
    truths = truth_of(straight, 60.0)
    late = poses_of(architecture, messages_of(straight, truths, Sensors(latency_s=0.5)))
    assert max(error_m(pose, truths) for pose in late[-50:]) < 0.5


@pytest.mark.parametrize("architecture", COMPARED)
def test_nothing_is_claimed_of_sensors_that_are_not_calibrated(
    architecture: ArchitectureName,
) -> None:
    last = only(outputs_of(architecture, made(town, 60.0, Sensors())), FusionStatus)[-1]
    assert (last.gyro_bias_degps, last.odometer_scale, last.calibration) == (None, None, "started")


@pytest.mark.parametrize("architecture", COMPARED)
def test_an_outage_ends_in_modes_and_stds_that_say_so(architecture: ArchitectureName) -> None:
    sensors = Sensors(gyro_bias_degps=0.5, odometer_scale=0.98, outage=(60.0, 170.0))
    truths = truth_of(town, 169.9)
    poses = poses_of(architecture, messages_of(town, truths, sensors))
    with_gps = "fused" if architecture == "uncoupled" else "gps"
    assert pose_at(poses, 59.0).mode == with_gps
    assert pose_at(poses, 65.0).mode == "dead_reckoning"
    assert pose_at(poses, 145.0).mode == "dead_reckoning", "lost takes 90 s too"
    assert poses[-1].mode == "lost"
    for pose in poses[200:]:
        std_m = math.hypot(pose.east_std_m or 0.0, pose.north_std_m or 0.0)
        assert error_m(pose, truths) < 3.0 * std_m


def test_uncoupled_believes_every_fix() -> None:
    """Loose coupling rejects the same one."""
    messages = made(straight, 60.0, Sensors())
    displaced(messages, 50.0, 200.0)
    moved_m = {}
    for architecture in ("loose", "uncoupled"):
        poses = poses_of(architecture, messages)
        before, after = place_m(pose_at(poses, 49.9)), place_m(pose_at(poses, 50.1))
        moved_m[architecture] = math.dist(before, after)
    assert moved_m["loose"] < 10.0
    assert moved_m["uncoupled"] == pytest.approx(200.0, abs=10.0)


def test_uncoupled_reckons_with_the_gyro_as_it_reads() -> None:
    """On a straight road a bias b bends the way by b v t^2 / 2, however long GPS showed it."""
    sensors = Sensors(gyro_bias_degps=0.5, outage=(240.0, 300.0))
    poses = poses_of("uncoupled", made(straight, 270.1, sensors))
    east_m, _ = place_m(pose_at(poses, 269.0))
    assert east_m == pytest.approx(0.5 * math.radians(0.5) * 20.0 * 30.0**2, rel=0.02)
    assert pose_at(poses, 269.0).heading_deg == about(15.0, 0.1)


def test_uncoupled_takes_the_wheels_at_their_word() -> None:
    sensors = Sensors(odometer_scale=0.95, outage=(100.0, 200.0))
    poses = poses_of("uncoupled", made(straight, 160.1, sensors))
    _, north_m = place_m(pose_at(poses, 159.0))
    assert north_m == pytest.approx(99.0 * 20.0 + 60.0 * 20.0 / 0.95, abs=1.0)


def test_uncoupled_is_far_worse_than_loose_where_the_gyro_is_biased() -> None:
    sensors = Sensors(gyro_bias_degps=0.4, outage=(300.0, 360.0))
    truths = truth_of(town, 359.0)
    messages = list(messages_of(town, truths, sensors))
    loose, uncoupled = (
        error_m(poses_of(architecture, messages)[-1], truths)
        for architecture in ("loose", "uncoupled")
    )
    assert uncoupled > 5.0 * loose


@pytest.mark.parametrize("architecture", GPS_ALONE)
def test_gps_alone_does_not_listen_to_the_vehicle(architecture: ArchitectureName) -> None:
    """Sensors that read nonsense change nothing."""
    sensors = Sensors(gps_noise_m=1.0, outage=(40.0, 50.0))
    good = made(town, 60.0, sensors)
    bad = made(town, 60.0, sensors._replace(gyro_bias_degps=20.0, odometer_scale=3.0))
    assert outputs_of(architecture, good) == outputs_of(architecture, bad)


@pytest.mark.parametrize("architecture", GPS_ALONE)
def test_gps_alone_goes_straight_on_at_constant_velocity(architecture: ArchitectureName) -> None:
    """The circle that the gyro measures is not followed; a pose a second all the same."""
    poses = poses_of(architecture, made(circle, 60.0, Sensors(outage=(30.0, 60.0))))
    outage = [pose for pose in poses if at(31.0) <= pose.t_ns <= at(59.0)]
    places_m = np.array([place_m(pose) for pose in outage])
    steps_m = np.diff(places_m, axis=0)
    assert len(outage) == 29
    assert np.hypot(*steps_m.T) == pytest.approx(np.full(28, 15.0), rel=0.02)
    assert np.ptp(steps_m, axis=0).max() < 0.1
    assert outage[-1].heading_deg == about(outage[0].heading_deg or 0.0, 0.1)


@pytest.mark.parametrize("architecture", GPS_ALONE)
def test_gps_alone_holds_the_heading_at_rest(architecture: ArchitectureName) -> None:
    def stop(seconds: float) -> tuple[float, float]:
        return (10.0, 3.0) if seconds < 30.0 else (0.0, 0.0)

    last = poses_of(architecture, made(stop, 60.0, Sensors(gps_noise_m=1.0)))[-1]
    assert last.speed_mps == about(0.0, 0.2)
    assert last.heading_deg == about(90.0, 10.0)


def test_fixes_of_few_satellites_move_the_modified_filter_less() -> None:
    """The same fix, 60 m off, of three satellites: papers/003's reason for the modification."""
    messages = made(straight, 60.0, Sensors(gps_noise_m=1.0))
    clean = {name: pose_at(poses_of(name, messages), 50.0) for name in GPS_ALONE}
    displaced(messages, 50.0, 60.0, satellites=3)
    pulled_m = {
        name: math.dist(place_m(pose_at(poses_of(name, messages), 50.0)), place_m(pose))
        for name, pose in clean.items()
    }
    assert pulled_m["gps_only"] > 1.0
    assert pulled_m["gps_only_modified"] < 0.1 * pulled_m["gps_only"]


def test_while_all_fixes_are_good_both_filters_for_gps_alone_are_one() -> None:
    messages = made(town, 60.0, Sensors(gps_noise_m=1.0))
    assert outputs_of("gps_only", messages) == outputs_of("gps_only_modified", messages)
