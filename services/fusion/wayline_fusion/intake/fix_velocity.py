"""Pure: speed and course of a receiver that reports neither, from where its fixes have moved."""

import math
from typing import NamedTuple

from wayline.geo import step_between
from wayline.messages import GpsFix

SHORTEST_M = 15.0
"""A way this long has a course worth having."""
LONGEST_NS = 10_000_000_000
"""A shorter way in this time says that the vehicle crawls or stands."""
FORGET_NS = 120_000_000_000
"""Over a longer silence the vehicle may have been anywhere."""
SPEED_FLOOR_MPS = 0.5
"""The mean over seconds is not the speed at its end."""


class MeanVelocity(NamedTuple):
    """Since an earlier fix."""

    speed_mps: float
    speed_std_mps: float
    course_deg: float | None
    course_std_deg: float | None


class FixVelocity:
    """Measures velocity from one anchor fix to the next."""

    def __init__(self) -> None:
        self._anchor: GpsFix | None = None

    def mean(self, fix: GpsFix, std_m: float) -> MeanVelocity | None:
        """Up to a valid fix of a given position std; None until it has moved or waited."""
        anchor = self._anchor
        if anchor is None or not 0 <= fix.t_ns - anchor.t_ns <= FORGET_NS:
            self._anchor = fix
            return None
        if None in (anchor.lat_deg, anchor.lon_deg, fix.lat_deg, fix.lon_deg):
            return None
        step = step_between(anchor.lat_deg, anchor.lon_deg, fix.lat_deg, fix.lon_deg)  # type: ignore[arg-type]
        elapsed_ns = fix.t_ns - anchor.t_ns
        if elapsed_ns == 0 or (step.distance_m < SHORTEST_M and elapsed_ns < LONGEST_NS):
            return None
        self._anchor = fix
        elapsed_s = elapsed_ns * 1e-9
        both_std_m = math.sqrt(2.0) * std_m
        speed_std_mps = math.hypot(both_std_m / elapsed_s, SPEED_FLOOR_MPS)
        speed_mps = step.distance_m / elapsed_s
        if step.distance_m < SHORTEST_M:
            return MeanVelocity(speed_mps, speed_std_mps, None, None)
        course_std_deg = math.degrees(math.atan2(both_std_m, step.distance_m))
        return MeanVelocity(speed_mps, speed_std_mps, step.bearing_deg, course_std_deg)
