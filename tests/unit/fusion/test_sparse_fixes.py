"""Fixes that come seldom, without speed, without course: what is made of them."""

import itertools
import math
from collections.abc import Iterable, Iterator, Sequence

import msgspec
import pytest

from builders import about, fix, only, run_core
from unit.fusion.drives import (
    ORIGIN,
    Motion,
    Sensors,
    Truth,
    error_m,
    heading_error_deg,
    messages_of,
    seconds_of,
    stop_and_go,
    straight,
    truth_at,
    truth_of,
    winding,
)
from wayline.messages import FusionStatus, GpsFix, Message, Pose, Verdict
from wayline.tuning import Tuning
from wayline_fusion.core import FusionCore

GPS = Sensors(gps_noise_m=1.5)


def thinned(
    messages: Iterable[Message],
    every_s: int = 1,
    without: Sequence[str] = (),
    *,
    blank: bool = False,
    can: bool = False,
) -> Iterator[Message]:
    """Only each n-th fix, without some fields; the others not at all, or as empty epochs."""
    for message in messages:
        if not isinstance(message, GpsFix):
            if can:
                yield message
        elif round(seconds_of(message.t_ns)) % every_s == 0:
            yield msgspec.structs.replace(message, **dict.fromkeys(without))
        elif blank:
            yield GpsFix(t_ns=message.t_ns, valid=False, satellites=0)


def driven(motion: Motion, duration_s: float) -> tuple[list[Truth], list[Message]]:
    truths = truth_of(motion, duration_s)
    return truths, list(messages_of(motion, truths, GPS))


def verdicts_of(out: Iterable[Message], sensor: str) -> list[Verdict]:
    return [
        verdict
        for status in only(out, FusionStatus)
        for verdict in status.verdicts
        if verdict.sensor == sensor
    ]


def refused(out: Iterable[Message]) -> list[float]:
    """When positions were rejected."""
    verdicts = verdicts_of(out, "gps_position")
    return [seconds_of(verdict.t_ns) for verdict in verdicts if not verdict.accepted]


def longest(times: Sequence[float]) -> int:
    """Of stretches of refused fixes that come once a second."""
    most = row = 0
    for before, time in itertools.pairwise([-9.0, *times]):
        row = row + 1 if time - before < 1.5 else 1
        most = max(most, row)
    return most


def fused(messages: Iterable[Message]) -> tuple[list[Message], list[Pose]]:
    out = run_core(FusionCore(Tuning()), messages)
    return out, only(out, Pose)


@pytest.mark.parametrize("blank", [False, True])
@pytest.mark.parametrize("every_s", [5, 15, 30, 60])
@pytest.mark.parametrize("motion", [winding, stop_and_go])
def test_fixes_that_come_seldom_are_all_believed(
    motion: Motion, every_s: int, *, blank: bool
) -> None:
    truths, messages = driven(motion, 899.0)
    out, poses = fused(thinned(messages, every_s, blank=blank))
    assert refused(out) == []
    assert "lost" not in {pose.mode for pose in poses}
    at_fixes = [pose for pose in poses if seconds_of(pose.t_ns) % every_s < 0.01]
    assert len(at_fixes) >= 900 // every_s - 1
    assert max(error_m(pose, truths) for pose in at_fixes[1:]) < 15.0


@pytest.mark.parametrize("every_s", [15, 30, 60])
def test_poses_go_on_between_fixes_once_a_second_and_say_how_sure_they_are(every_s: int) -> None:
    truths, messages = driven(stop_and_go, 899.0)
    _, poses = fused(thinned(messages, every_s))
    located = [pose for pose in poses if pose.mode != "starting"]
    assert len(located) > 750
    honest = [
        error_m(pose, truths) <= 2.0 * math.hypot(pose.east_std_m or 0.0, pose.north_std_m or 0.0)
        for pose in located
    ]
    assert sum(honest) / len(honest) > 0.85
    assert {pose.mode for pose in located} == {"gps"}


def test_a_fix_that_is_missing_is_told_by_the_source_s_own_interval() -> None:
    _, messages = driven(straight, 400.0)
    told = [message for message in thinned(messages, 30) if seconds_of(message.t_ns) < 241.0]
    told.append(fix(400.0, 57.0, 10.0))
    _, poses = fused(told)
    modes = {round(seconds_of(pose.t_ns)): pose.mode for pose in poses}
    assert modes[284] == "gps"
    assert modes[287] == "dead_reckoning"
    assert modes[329] == "dead_reckoning", "no accepted fix for less than three intervals"
    assert modes[332] == "lost"


def starts_round_a_corner(seconds: float) -> tuple[float, float]:
    """Minute after minute: stand, drive off, turn right by 90 degrees while that is slow."""
    within_s = seconds % 60.0
    if within_s < 20.0:
        return 0.0, 0.0
    if within_s < 32.0:
        return min(within_s - 20.0, 12.0), 30.0 if 21.0 <= within_s < 24.0 else 0.0
    return 12.0 if within_s < 50.0 else max(12.0 - 1.5 * (within_s - 50.0), 0.0), 0.0


def test_velocities_lead_from_fix_to_fix_where_positions_are_worth_little() -> None:
    """Every 5 s; but for the first minute positions are vague, speed and course are good."""
    truths, messages = driven(starts_round_a_corner, 300.0)
    told = [
        msgspec.structs.replace(message, h_std_m=100.0)
        if isinstance(message, GpsFix) and seconds_of(message.t_ns) > 62.0
        else message
        for message in thinned(messages, 5)
    ]
    _, poses = fused(told)
    at_fixes = [pose for pose in poses if seconds_of(pose.t_ns) % 5 < 0.01]
    errors_m = sorted(error_m(pose, truths) for pose in at_fixes[2:])
    assert errors_m[round(0.9 * len(errors_m))] < 8.0


@pytest.mark.parametrize("every_s", [30, 60])
def test_with_wheels_and_gyro_seldom_fixes_are_believed_and_predicted(every_s: int) -> None:
    truths = truth_of(winding, 1199.0)
    sensors = Sensors(gyro_bias_degps=0.3, odometer_scale=0.98, gps_noise_m=1.5)
    messages = list(messages_of(winding, truths, sensors))
    out, poses = fused(thinned(messages, every_s, can=True))
    assert refused(out) == []
    late = [error_m(pose, truths) for pose in poses if seconds_of(pose.t_ns) > 600.0]
    assert max(late) < 20.0


@pytest.mark.parametrize("off_deg", [4.0, -4.0])
def test_one_course_off_by_degrees_among_seldom_ones_bends_no_way(off_deg: float) -> None:
    truths = truth_of(winding, 1199.0)
    sensors = Sensors(gyro_bias_degps=0.3, odometer_scale=0.98, gps_noise_m=1.5)
    glitch = [
        msgspec.structs.replace(message, course_deg=((message.course_deg or 0.0) + off_deg) % 360.0)
        if isinstance(message, GpsFix) and round(seconds_of(message.t_ns)) == 720
        else message
        for message in messages_of(winding, truths, sensors)
    ]
    out, poses = fused(thinned(glitch, 60, can=True))
    assert refused(out) == []
    assert max(error_m(pose, truths) for pose in poses if seconds_of(pose.t_ns) > 600.0) < 15.0


def test_reports_without_speed_tell_it_by_where_they_have_moved() -> None:
    truths, messages = driven(winding, 599.0)
    out, poses = fused(thinned(messages, 10, ["speed_mps", "course_deg"]))
    assert len(refused(out)) <= 1
    assert poses[-1].mode == "gps"
    for pose in poses[200:]:
        assert pose.speed_mps is not None
        assert pose.speed_std_mps is not None
        off_mps = abs(pose.speed_mps - truth_at(pose.t_ns, truths).speed_mps)
        assert off_mps < 3.0 * pose.speed_std_mps + 1.0


def test_a_report_s_heading_counts_where_it_has_moved() -> None:
    truths, messages = driven(straight, 121.0)
    reports = list(thinned(messages, 30, ["speed_mps"]))
    wrong = [msgspec.structs.replace(report, course_deg=5.0) for report in reports[2:]]
    _, poses = fused([*reports[:2], *wrong])
    headings = {round(seconds_of(pose.t_ns)): pose.heading_deg for pose in poses}
    assert headings[30] == about(0.0, 1.0) or headings[30] == about(360.0, 1.0)
    assert headings[120] == about(3.0, 3.0)
    assert truth_at(poses[-1].t_ns, truths).heading_deg == 0.0


def gently(seconds: float) -> tuple[float, float]:
    """A main road: bends of 300 m."""
    return 15.0, 3.0 * math.sin(seconds / 9.0)


def zigzag(seconds: float) -> tuple[float, float]:
    """Blocks of a town: a right angle to the left or to the right every forty seconds."""
    rate_degps = 30.0 if seconds % 40.0 < 3.0 else 0.0
    return 10.0, rate_degps if seconds % 80.0 < 40.0 else -rate_degps


def test_a_report_s_heading_moves_no_pose_away_from_the_report() -> None:
    truths, messages = driven(zigzag, 601.0)
    reports = [
        msgspec.structs.replace(report, course_deg=truth_at(report.t_ns, truths).heading_deg)
        for report in thinned(messages, 30, ["speed_mps"])
    ]
    out, poses = fused(reports)
    assert refused(out) == []
    at_reports = [pose for pose in poses if round(seconds_of(pose.t_ns)) % 30 == 0]
    assert max(error_m(pose, truths) for pose in at_reports) < 10.0


@pytest.mark.parametrize(("motion", "can"), [(gently, False), (winding, True)])
def test_a_speed_without_a_course_gets_a_heading_after_two_hundred_metres(
    motion: Motion, *, can: bool
) -> None:
    truths, messages = driven(motion, 300.0)
    out, poses = fused(thinned(messages, 1, ["course_deg"], can=can))
    assert longest(refused(out)) <= 5
    later = [pose for pose in poses if truth_at(pose.t_ns, truths).path_m > 200.0]
    assert all(pose.mode != "starting" for pose in later)
    assert sorted(heading_error_deg(pose, truths) for pose in later)[len(later) * 95 // 100] < 10.0


def test_wheels_that_tell_reverse_turn_the_displacement_round() -> None:
    def backwards(seconds: float) -> tuple[float, float]:
        return (0.0 if seconds < 3.0 else -4.0), 0.0

    truths, messages = driven(backwards, 60.0)
    _, poses = fused(thinned(messages, 1, ["course_deg"], can=True))
    assert poses[-1].mode == "fused"
    assert heading_error_deg(poses[-1], truths) < 10.0
    assert poses[-1].speed_mps == about(-4.0, 0.3)


def sharp_turn(seconds: float) -> tuple[float, float]:
    """Straight on, a right angle within two seconds and a bit, then a stand."""
    if seconds < 200.0:
        return 6.5, 42.0 if 190.0 <= seconds < 192.2 else 0.0
    return 0.0, 0.0


@pytest.mark.parametrize("seed", [1, 2, 3])
@pytest.mark.parametrize("without", [(), ("course_deg",), ("speed_mps", "course_deg")])
def test_a_sharp_turn_without_a_gyro_locks_no_good_fix_out(
    seed: int, without: Sequence[str]
) -> None:
    truths = truth_of(sharp_turn, 280.0)
    messages = messages_of(sharp_turn, truths, GPS, seed)
    out, poses = fused(thinned(messages, 1, without))
    assert longest(refused(out)) <= 10
    assert error_m(poses[-1], truths) < 5.0


def test_one_displaced_report_of_many_is_still_rejected() -> None:
    truths, messages = driven(straight, 600.0)
    told = []
    for message in thinned(messages, 5):
        if seconds_of(message.t_ns) == about(300.0, 0.1):
            truth = truth_at(message.t_ns, truths)
            lat_deg, lon_deg = ORIGIN.to_geodetic(truth.east_m + 500.0, truth.north_m)
            message = msgspec.structs.replace(message, lat_deg=lat_deg, lon_deg=lon_deg)  # noqa: PLW2901
        told.append(message)
    out, _ = fused(told)
    assert refused(out) == [about(300.0, 0.1)]
