"""A real drive through fusion with faults: bounded while they last, right again in seconds.

css-164 in town at 60 km/h: a car's own CAN bus with an OBD speed twice a second, and a phone-grade
receiver. The first ten minutes are driven once; each fault starts from there.
"""

import copy
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest
from numpy.typing import NDArray

from builders import only
from faults import (
    Fault,
    clock_stepped,
    displaced,
    duplicated,
    gyro_reads,
    out_of_order,
    receiver_frozen,
    tunnel,
    wheels_read,
    without,
)
from wayline.drive_file import load_drive
from wayline.geo import WGS84
from wayline.messages import (
    Barometer,
    FusionStatus,
    GpsFix,
    Gyro,
    Message,
    Odometer,
    Pose,
    Verdict,
)
from wayline.node import Node
from wayline_evaluation.estimates import Estimates, estimates_of
from wayline_fusion.core import FusionCore
from wayline_replay.stream import DriveStream

BEFORE_S, FAULT_S, END_S = 590.0, 600.0, 720.0
SECOND_NS = 1_000_000_000
MODES = {"starting", "gps", "fused", "dead_reckoning", "lost"}
Floats = NDArray[np.float64]


class Drive(NamedTuple):
    """The drive shortly before the fault, and what is still to come."""

    start_ns: int
    node: Node
    rest: list[Message]
    clean: Estimates
    clean_distance_m: float


class Faulty(NamedTuple):
    """What fusion made of a fault."""

    seconds: Floats
    """Since the fault began, of each pose."""
    apart_m: Floats
    """From the drive without the fault."""
    turned_deg: Floats
    poses: list[Pose]
    rejected: list[Verdict]
    clean_distance_m: float

    def settled_after_s(self, within_m: float) -> float:
        """When it was further off than this for the last time."""
        off = self.seconds[self.apart_m > within_m]
        return float(off[-1]) if len(off) else 0.0

    def modes(self, from_s: float, to_s: float) -> set[str]:
        """During a part of the drive."""
        there = (self.seconds >= from_s) & (self.seconds < to_s)
        return {pose.mode for pose, is_there in zip(self.poses, there, strict=True) if is_there}

    def says(self, sensor: str) -> set[str | None]:
        """Reasons why a sensor's measurements were rejected."""
        return {verdict.reason for verdict in self.rejected if verdict.sensor == sensor}


def driven(node: Node, messages: list[Message]) -> list[Message]:
    return [output for message in messages for output in node.take(message, "test")]


@pytest.fixture(scope="module")
def loaded() -> dict[Path, Drive]:
    return {}


@pytest.fixture
def faulty(recorded: Callable[[str], Path], loaded: dict[Path, Drive]) -> Callable[..., Faulty]:
    folder = recorded("css-164")
    if folder not in loaded:
        loaded[folder] = start(folder)
    drive = loaded[folder]

    def run(fault: Fault, clock_step_s: float = 0.0) -> Faulty:
        return with_fault(drive, fault, clock_step_s)

    return run


def start(folder: Path) -> Drive:
    drive = load_drive(folder)
    messages: list[Message] = []
    for arrival in DriveStream(drive, str(folder)):
        messages.append(arrival.message)
        if arrival.message.t_ns - messages[0].t_ns > END_S * 1e9:
            break
    start_ns = messages[0].t_ns
    split = next(i for i, m in enumerate(messages) if m.t_ns - start_ns > BEFORE_S * 1e9)
    node = Node("fusion", FusionCore(drive.tuning))
    driven(node, messages[:split])
    clean = only(driven(copy.deepcopy(node), messages[split:]), Pose)
    return Drive(start_ns, node, messages[split:], estimates_of(clean), clean[-1].distance_m)


def with_fault(drive: Drive, fault: Fault, clock_step_s: float) -> Faulty:
    """The rest of the drive with a fault; `clock_step_s` says how wrong its clock is then."""
    outputs = driven(copy.deepcopy(drive.node), fault(drive.rest, drive.start_ns))
    poses: list[Pose] = only(outputs, Pose)
    there = estimates_of(poses)
    began_s = drive.start_ns * 1e-9 + FAULT_S
    true_s = there.times_s - np.where(there.times_s >= began_s + clock_step_s, clock_step_s, 0.0)
    clean = drive.clean.at(true_s)
    apart_m = WGS84.inv(there.lons_deg, there.lats_deg, clean.lons_deg, clean.lats_deg)[2]
    turned_deg = np.abs((there.headings_deg - clean.headings_deg + 180.0) % 360.0 - 180.0)
    verdicts = [verdict for status in only(outputs, FusionStatus) for verdict in status.verdicts]
    result = Faulty(
        there.times_s - began_s,
        np.asarray(apart_m),
        turned_deg,
        poses,
        [verdict for verdict in verdicts if not verdict.accepted],
        drive.clean_distance_m,
    )
    is_sane(result)
    return result


def is_sane(result: Faulty) -> None:
    """What holds whatever happens."""
    poses = result.poses
    assert (np.diff([pose.t_ns for pose in poses]) > 0).all()
    assert (np.diff([pose.distance_m for pose in poses]) >= 0.0).all()
    assert {pose.mode for pose in poses} <= MODES
    assert np.isfinite(result.apart_m).all()
    assert all((pose.east_std_m or 0.0) + (pose.north_std_m or 0.0) < 1000.0 for pose in poses)
    assert all(verdict.reason for verdict in result.rejected)
    assert poses[-1].mode in {"fused", "dead_reckoning"}


@pytest.mark.parametrize(
    "gone", [without((GpsFix,), (600.0, 660.0)), tunnel((600.0, 660.0))], ids=["silent", "blind"]
)
def test_gps_that_goes_away_midway_is_dead_reckoned(
    faulty: Callable[..., Faulty], gone: Fault
) -> None:
    """A minute and a kilometre: whether the receiver falls silent or says that it sees nothing."""
    result = faulty(gone)
    assert result.modes(3.0, 60.0) == {"dead_reckoning"}
    assert result.apart_m.max() < 25.0
    assert result.settled_after_s(5.0) < 65.0


def test_gps_that_stays_away_is_dead_reckoned_to_the_end(faulty: Callable[..., Faulty]) -> None:
    """Two minutes into a tunnel without end; honest about it."""
    result = faulty(tunnel((600.0, END_S)))
    last = result.poses[-1]
    assert result.apart_m[-1] < 60.0
    assert result.apart_m[-1] < 4.0 * np.hypot(last.east_std_m or 0.0, last.north_std_m or 0.0)


@pytest.mark.parametrize("off_m", [60.0, 700.0])
def test_fixes_far_off_are_rejected_while_they_last(
    faulty: Callable[..., Faulty], off_m: float
) -> None:
    """20 s of a reflection, as sure of themselves as ever."""
    result = faulty(displaced((600.0, 620.0), off_m, 0.0))
    assert result.apart_m.max() < 3.0
    assert len([v for v in result.rejected if v.sensor == "gps_position"]) >= 15
    assert all(v.nis > v.threshold for v in result.rejected if v.sensor == "gps_position")


def test_a_gyro_spike_is_refused(faulty: Callable[..., Faulty]) -> None:
    """A tenth of a second of 200 deg/s at 15 m/s: tyres do not hold that."""
    result = faulty(gyro_reads((600.0, 600.1), 200.0))
    assert result.apart_m.max() < 1.0
    assert result.turned_deg.max() < 1.0
    assert result.says("gyro") == {"no vehicle turns so fast at its speed"}


def test_a_small_gyro_spike_is_corrected_by_the_courses(faulty: Callable[..., Faulty]) -> None:
    """Plausible, and ten degrees wrong."""
    result = faulty(gyro_reads((600.0, 600.3), 40.0))
    assert result.apart_m.max() < 40.0
    assert result.settled_after_s(5.0) < 12.0


def test_a_gyro_stuck_at_zero_is_found_out_by_the_courses(faulty: Callable[..., Faulty]) -> None:
    """20 s with bends; then position and heading are right again, and the bias is not lost."""
    result = faulty(gyro_reads((600.0, 620.0), 0.0))
    assert result.apart_m.max() < 40.0
    assert result.settled_after_s(5.0) < 30.0
    assert result.turned_deg[-1] < 1.0
    assert result.says("gps_course")


@pytest.mark.parametrize(
    "silent",
    [(Gyro,), (Odometer,), (Gyro, Odometer, Barometer)],
    ids=["gyro", "wheels", "can"],
)
def test_a_silent_bus_is_bridged_by_gps(
    faulty: Callable[..., Faulty], silent: tuple[type[Message], ...]
) -> None:
    """20 s: without CAN the mode says so."""
    result = faulty(without(silent, (600.0, 620.0)))
    assert result.apart_m.max() < 10.0
    assert result.settled_after_s(3.0) < 25.0
    if silent == (Gyro, Odometer, Barometer):
        assert "gps" in result.modes(2.0, 20.0)
        assert "fused" not in result.modes(2.0, 20.0)


def test_everything_twice_is_no_more_than_once(faulty: Callable[..., Faulty]) -> None:
    result = faulty(duplicated)
    assert result.apart_m.max() < 2.0
    assert result.poses[-1].distance_m == pytest.approx(result.clean_distance_m, rel=1e-3)


@pytest.mark.parametrize(
    "disorder",
    [
        out_of_order((GpsFix, Odometer, Barometer), 1.0),
        out_of_order((Gyro,), 0.05),
        out_of_order((Message,), 1.0),
    ],
    ids=["fixes and wheels", "gyro", "all"],
)
def test_disorder_of_up_to_a_second_is_put_right(
    faulty: Callable[..., Faulty], disorder: Fault
) -> None:
    result = faulty(disorder)
    assert result.apart_m.max() < 3.0
    assert result.apart_m[-1] < 1.0


@pytest.mark.parametrize("step_s", [2.0, -2.0])
def test_a_clock_that_steps_costs_seconds(faulty: Callable[..., Faulty], step_s: float) -> None:
    """The vehicle is where its fixes say, not 2 s further; to dead reckoning it jumped 30 m."""
    result = faulty(clock_stepped(FAULT_S, step_s), step_s)
    assert result.apart_m.max() < 50.0
    assert result.settled_after_s(5.0) < 8.0


@pytest.mark.parametrize("lasting_s", [10.0, 60.0])
def test_a_frozen_receiver_is_found_out(faulty: Callable[..., Faulty], lasting_s: float) -> None:
    """It repeats position, speed and course of one fix with new times; the wheels know better."""
    result = faulty(receiver_frozen((600.0, 600.0 + lasting_s)))
    assert result.apart_m.max() < 25.0
    assert result.settled_after_s(5.0) < lasting_s + 5.0
    assert result.modes(4.0, lasting_s) == {"dead_reckoning"}
    assert "the receiver repeats a position that the vehicle has left" in result.says(
        "gps_position"
    )


def test_wheels_that_lock_for_a_second_are_not_believed(faulty: Callable[..., Faulty]) -> None:
    result = faulty(wheels_read((600.0, 601.0), 0.0))
    assert result.apart_m.max() < 3.0
    assert result.says("odometer")


def test_wheels_that_lock_for_longer_mislead_for_seconds_only(
    faulty: Callable[..., Faulty],
) -> None:
    """After a while they are believed, and once they turn again the fixes are."""
    result = faulty(wheels_read((600.0, 603.0), 0.0))
    assert result.apart_m.max() < 80.0
    assert result.settled_after_s(5.0) < 12.0


def test_wheels_that_spin_are_not_believed(faulty: Callable[..., Faulty]) -> None:
    """20 km/h too fast for two seconds."""
    result = faulty(wheels_read((600.0, 602.0), 1.0, 6.0))
    assert result.apart_m.max() < 15.0
    assert result.settled_after_s(5.0) < 8.0
    assert result.says("odometer")
