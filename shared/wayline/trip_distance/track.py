"""Pure: the fixes of a trip as arrays, in order of time, and how far each can be trusted."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from wayline.geo import WGS84, step_between
from wayline.gps_quality import is_good
from wayline.messages import GpsFix
from wayline.trip_distance.integrated_walk import Flags, Floats
from wayline.tuning import Tuning


@dataclass(frozen=True)
class Track:
    """Valid fixes at n instants that increase; nan where a receiver does not tell."""

    times_s: Floats
    """Since the first one."""
    lats_deg: Floats
    lons_deg: Floats
    speeds_mps: Floats
    """As measured by Doppler; nan where the speed is derived from positions."""
    courses_deg: Floats
    speed_stds_mps: Floats
    """One sigma of a speed, by the receiver's own word or by HDOP, satellites and PDOP."""
    good: Flags
    """At least 4 satellites and PDOP at most 8 (papers/003)."""

    def __len__(self) -> int:
        return len(self.times_s)

    @cached_property
    def _steps(self) -> tuple[Floats, Floats]:
        """Bearings halfway, in radians, and lengths: a leap there and back adds up to nothing."""
        there_deg, back_deg, chords_m = WGS84.inv(
            self.lons_deg[:-1], self.lats_deg[:-1], self.lons_deg[1:], self.lats_deg[1:]
        )
        turns_deg = (np.asarray(back_deg) - there_deg) % 360.0 - 180.0
        return np.radians(there_deg + 0.5 * turns_deg), np.asarray(chords_m)

    @property
    def chords_m(self) -> Floats:
        """Straight lines from fix to fix, shape (n - 1,)."""
        return self._steps[1]

    def chord_m(self, begin: int, end: int) -> float:
        """The straight line between two fixes."""
        ends = self.lats_deg[begin], self.lons_deg[begin], self.lats_deg[end], self.lons_deg[end]
        return step_between(*map(float, ends)).distance_m

    @cached_property
    def places_m(self) -> Floats:
        """East and north of the first fix, shape (n, 2): steps added up, each in its own plane."""
        bearings_rad = self._steps[0]
        steps_m = self.chords_m[:, np.newaxis] * np.column_stack(
            (np.sin(bearings_rad), np.cos(bearings_rad))
        )
        return np.concatenate((np.zeros((1, 2)), np.cumsum(steps_m, axis=0)))

    @cached_property
    def steps_s(self) -> Floats:
        """Times from fix to fix, shape (n - 1,)."""
        return np.diff(self.times_s)


def track_of(fixes: Sequence[GpsFix], tuning: Tuning) -> Track:
    """Of valid fixes in order of time; speeds that are derived from positions are left out."""
    return Track(
        times_s=np.array([(fix.t_ns - fixes[0].t_ns) * 1e-9 for fix in fixes]),
        lats_deg=_column([fix.lat_deg for fix in fixes]),
        lons_deg=_column([fix.lon_deg for fix in fixes]),
        speeds_mps=_column([None if fix.speed_derived else fix.speed_mps for fix in fixes]),
        courses_deg=_column([fix.course_deg for fix in fixes]),
        speed_stds_mps=np.array([speed_std_mps(fix, tuning) for fix in fixes]),
        good=np.array([is_good(fix, tuning) for fix in fixes]),
    )


def _column(values: Sequence[float | None]) -> Floats:
    return np.array([math.nan if value is None else value for value in values])


def speed_std_mps(fix: GpsFix, tuning: Tuning) -> float:
    """One sigma of a fix's speed: its own where reported, else by HDOP; more of a bad fix."""
    if fix.speed_std_mps is not None:
        return max(fix.speed_std_mps, tuning.gps_speed_std_mps)
    std_mps = tuning.gps_speed_std_mps * max(fix.hdop or 1.0, 1.0)
    return std_mps if is_good(fix, tuning) else std_mps * tuning.bad_gps_factor
