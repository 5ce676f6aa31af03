"""Pure: which positions of a vehicle are followed: fusion's poses, or its reports themselves.

A pose between two fixes goes straight on where no wheels tell better, so it is followed only while
fixes come within seconds and it is sure of its place. Else the reports are, each at its own time,
and between them the route tells how the vehicle goes on.
"""

import math
from typing import NamedTuple

import msgspec

from wayline.cadence import Cadence
from wayline.geo import step_between
from wayline.messages import GpsFix, Pose, stale_after_s
from wayline.tuning import Tuning

SELDOM_S = 5.0
"""Reports farther apart are followed themselves."""
STALE_AFTER_S, STALE_INTERVALS = 90.0, 3.0
"""Reports are old after the longer of this and so many of their usual intervals (SPEC section 3)"""
REPORT_STD_M = 10.0
"""Per axis, of a report that says nothing of it: rounded, and seconds off its time."""
HEADING_STD_DEG = 30.0
"""Of the direction from one report to the next, where a report tells no course."""
DIRECTED_M = 30.0
"""Nearer reports tell no direction, and of vehicles that stand they tell old ones."""
FASTEST_MPS, LEAP_M = 60.0, 500.0
"""Who reports from farther off was not driven there: a wrong position, or another vehicle that has
the same id. Where the next report is near it, it was right."""
HELD_MAX = 64
"""Reports whose time has not come."""


class Sighting(NamedTuple):
    """A position that is followed; `distance_m` of its pose goes on over all sightings."""

    pose: Pose
    reported: bool
    """Nothing is known of the way since the last one; `speed_mps` is null where it is not told."""


class LeftOut:
    """Reports of places where nobody could have driven to, of all vehicles that share it."""

    def __init__(self) -> None:
        self.count = 0


class Sightings:
    """Of one vehicle; what it does not follow it adds to `left_out`."""

    def __init__(self, tuning: Tuning, left_out: LeftOut | None = None) -> None:
        self._tuning, self._left_out = tuning, left_out or LeftOut()
        self._held: list[tuple[GpsFix, str]] = []
        self._cadences: dict[str, Cadence] = {}
        self._fix_ns: int | None = None
        self._pose: Pose | None = None
        """The last one with a position."""
        self._has_wheels = False
        self._last: Sighting | None = None
        self._leapt: Pose | None = None
        """The last report, where it lies where nobody could have driven to."""
        self._offset_m = 0.0
        """Of `distance_m` of sightings from that of poses."""

    @property
    def by_reports(self) -> bool:
        """Whether the last sighting was a report."""
        return self._last is not None and self._last.reported

    @property
    def stale_after_s(self) -> float:
        """Age of the last sighting at which it is no longer the present."""
        if not self.by_reports:
            return self._tuning.eta_stale_after_s
        return max(STALE_AFTER_S, STALE_INTERVALS * self._usual_s)

    @property
    def forgotten_after_s(self) -> float:
        """Age of the last sighting at which nothing rests on it any longer."""
        return max(self._tuning.eta_forget_after_s, self.stale_after_s)

    def take_fix(self, fix: GpsFix, source: str) -> None:
        """Hold a report until its time has come."""
        if fix.valid and fix.lat_deg is not None and fix.lon_deg is not None:
            self._held = [*self._held[-HELD_MAX + 1 :], (fix, source)]

    def take_pose(self, pose: Pose) -> list[Sighting]:
        """What is followed once a pose has come."""
        if pose.lat_deg is None or pose.lon_deg is None or pose.mode == "lost":
            return self.pass_time(pose.t_ns)
        if pose.mode in {"fused", "gps"}:
            self._has_wheels = pose.mode == "fused"
        self._pose = pose
        seen = self.pass_time(pose.t_ns)
        if self._follows_reports(pose.t_ns):
            return seen
        return [*seen, self._seen(self._going_on(pose), reported=False)]

    def pass_time(self, t_ns: int) -> list[Sighting]:
        """What is followed of the reports whose time has come."""
        due = sorted((each for each in self._held if each[0].t_ns <= t_ns), key=_time)
        self._held = [each for each in self._held if each[0].t_ns > t_ns]
        for fix, source in due:
            self._cadences[source] = self._cadences.get(source, Cadence()).noticed(fix.t_ns)
            self._fix_ns = max(self._fix_ns or 0, fix.t_ns)
        if not self._follows_reports(t_ns):
            return []
        begun = []
        if self._last is not None and not self._last.reported:
            begun = [self._seen(self._last.pose, reported=True)]
        return begun + [seen for fix, _ in due if (seen := self._report(fix)) is not None]

    @property
    def _usual_s(self) -> float:
        return min((each.usual_s for each in self._cadences.values()), default=0.0)

    def _follows_reports(self, t_ns: int) -> bool:
        if self._fix_ns is None:
            return False
        pose = self._pose
        if pose is None or (t_ns - pose.t_ns) * 1e-9 > stale_after_s(Pose):
            return True
        if self._has_wheels:
            return False
        if max(self._usual_s, (t_ns - self._fix_ns) * 1e-9) > SELDOM_S:
            return True
        # before a vehicle has driven nobody knows better where it is than its first fix
        return pose.mode != "starting" and _is_unsure(pose, self._tuning.on_route_m)

    def _seen(self, pose: Pose, *, reported: bool) -> Sighting:
        self._last = Sighting(pose, reported)
        return self._last

    def _going_on(self, pose: Pose) -> Pose:
        """A pose whose distance goes on from the last sighting's."""
        if self._last is not None and self._last.reported:
            moved_m, _ = _step(self._last.pose, pose.lat_deg, pose.lon_deg)
            self._offset_m = self._last.pose.distance_m + moved_m - pose.distance_m
        if self._offset_m == 0.0:
            return pose
        return msgspec.structs.replace(pose, distance_m=max(pose.distance_m + self._offset_m, 0.0))

    def _report(self, fix: GpsFix) -> Sighting | None:
        """A report as a pose; None for one that is no newer than the last sighting."""
        last = self._last.pose if self._last is not None else None
        if last is not None and fix.t_ns <= last.t_ns:
            return None
        moved_m, bearing_deg = _step(last, fix.lat_deg, fix.lon_deg)
        speed_mps = None if fix.speed_derived else fix.speed_mps
        is_directed = moved_m >= DIRECTED_M or (speed_mps or 0.0) >= self._tuning.eta_moving_mps
        if last is None or is_directed:
            heading_deg, heading_std_deg = fix.course_deg, fix.course_std_deg
        else:
            heading_deg = heading_std_deg = None
        if heading_deg is None and moved_m >= DIRECTED_M:
            heading_deg, heading_std_deg = bearing_deg, HEADING_STD_DEG
        std_m = self._std_m(fix)
        report = Pose(
            t_ns=fix.t_ns,
            mode="gps",
            lat_deg=fix.lat_deg,
            lon_deg=fix.lon_deg,
            heading_deg=heading_deg,
            heading_std_deg=heading_std_deg,
            speed_mps=speed_mps,
            distance_m=moved_m + (last.distance_m if last is not None else 0.0),
            east_std_m=std_m,
            north_std_m=std_m,
        )
        return self._seen(report, reported=True) if self._is_believed(last, report) else None

    def _is_believed(self, last: Pose | None, report: Pose) -> bool:
        """Not a leap that no other report bears out."""
        leapt, self._leapt = self._leapt, None
        if not _leaps(last, report) or (leapt is not None and not _leaps(leapt, report)):
            return True
        self._leapt = report
        self._left_out.count += 1
        return False

    def _std_m(self, fix: GpsFix) -> float:
        if fix.h_std_m is not None:
            return max(fix.h_std_m / math.sqrt(2.0), self._tuning.gps_position_std_floor_m)
        if fix.hdop is not None:
            return max(REPORT_STD_M, fix.hdop * self._tuning.gps_range_std_m)
        return REPORT_STD_M


def _time(held: tuple[GpsFix, str]) -> int:
    return held[0].t_ns


def _is_unsure(pose: Pose, limit_m: float) -> bool:
    return max(pose.east_std_m or 0.0, pose.north_std_m or 0.0) > limit_m


def _leaps(last: Pose | None, report: Pose) -> bool:
    moved_m, _ = _step(last, report.lat_deg, report.lon_deg)
    apart_s = (report.t_ns - last.t_ns) * 1e-9 if last is not None else 0.0
    return moved_m > LEAP_M + FASTEST_MPS * apart_s


def _step(last: Pose | None, lat_deg: float | None, lon_deg: float | None) -> tuple[float, float]:
    """Straight distance and bearing from the last sighting."""
    if last is None or last.lat_deg is None or last.lon_deg is None:
        return 0.0, 0.0
    if lat_deg is None or lon_deg is None:
        return 0.0, 0.0
    step = step_between(last.lat_deg, last.lon_deg, lat_deg, lon_deg)
    return step.distance_m, step.bearing_deg
