"""Pure: whether the first fixes after a restart say that the vehicle was moved while it was off.

A ferry or a tow truck moves a vehicle by more than any dead reckoning is off, so what is kept of
its pose counts for less than one fix.
"""

import math

from wayline.messages import Verdict
from wayline.tuning import Tuning
from wayline_fusion.evidence.memory import Memory
from wayline_fusion.filter import measurements
from wayline_fusion.filter.gate import judge, nis_of
from wayline_fusion.filter.horizontal import HorizontalFilter
from wayline_fusion.filter.measurements import Measurement
from wayline_fusion.intake.events import Fix

COURSE_SLACK_DEG = 5.0
"""Of a course in a bend; what was moved is turned by more."""
REASON = "the vehicle is not where it was switched off; the pose kept is forgotten"


def tells_course(fix: Fix, tuning: Tuning) -> bool:
    """Whether a fix has a course worth comparing a heading with."""
    if fix.course_rad is None or fix.speed_mps is None:
        return False
    return fix.speed_mps >= tuning.course_speed_min_mps


def contradiction(
    kalman: HorizontalFilter, memory: Memory, fix: Fix, tuning: Tuning
) -> Verdict | None:
    """What speaks against a pose that no fix has confirmed since the restart."""
    doubted: list[tuple[Measurement, float]] = []
    if memory.position_unconfirmed and memory.plane is not None:
        east_m, north_m = memory.plane.to_plane(fix.lat_deg, fix.lon_deg)
        slow_std_m = kalman.slow_std_m(fix.position_std_m)
        white_std_m = math.sqrt(fix.position_std_m**2 - slow_std_m**2)
        position = measurements.position(kalman.x, east_m, north_m, slow_std_m, white_std_m)
        doubted.append((position, tuning.reacquire_probability))
    if memory.heading_unconfirmed and tells_course(fix, tuning):
        doubted.append((_course(kalman, fix), tuning.gate_probability))
    for measurement, probability in doubted:
        nis = nis_of(measurement, kalman.expected(measurement))
        verdict = judge(
            f"kept_{measurement.sensor}", fix.t_ns, nis, len(measurement.y), probability
        )
        if not verdict.accepted:
            return _because(verdict)
    return None


def _course(kalman: HorizontalFilter, fix: Fix) -> Measurement:
    doppler_rad = fix.course_std_rad or fix.speed_std_mps / (fix.speed_mps or math.inf)
    std_rad = math.hypot(doppler_rad, math.radians(COURSE_SLACK_DEG))
    return measurements.course(kalman.x, fix.course_rad or 0.0, std_rad, 0.0)


def _because(verdict: Verdict) -> Verdict:
    return Verdict(
        sensor=verdict.sensor,
        t_ns=verdict.t_ns,
        accepted=False,
        nis=verdict.nis,
        threshold=verdict.threshold,
        reason=REASON,
    )
