"""Pure: whether the first fixes after a restart say that the vehicle was moved while it was off.

A ferry or a tow truck moves a vehicle by more than any dead reckoning is off, so what is kept of
its pose counts for less than one fix.
"""

import math

from wayline.likelihood import Measurement
from wayline.tuning import Tuning
from wayline_fusion.filter import measurements
from wayline_fusion.filter.estimate import Estimate
from wayline_fusion.filter.gate import UNUSED, Outcome, Policy, try_measurement
from wayline_fusion.intake.events import Fix

COURSE_SLACK_DEG = 5.0
"""Of a course in a bend; what was moved is turned by more."""
REASON = "the vehicle is not where it was switched off; the pose kept is forgotten"


class KeptPose:
    """A pose that was kept over a restart, against the fixes.

    Starts: with a pose that was restored, until a fix has told its position and a course its
    heading. Goes on: a fix within the gate confirms, and then corrects as ever. Stops: confirmed.
    Resets: the first fix beyond the gate has position, heading and speed forgotten.
    """

    def __init__(self) -> None:
        self.evidence = None

    def take(self, estimate: Estimate, fix: Fix) -> Outcome:
        """Compare a fix with what was kept, before anything of it is used."""
        situation = estimate.situation
        if not (situation.position_unconfirmed or situation.heading_unconfirmed):
            return UNUSED
        outcome = self._compared(estimate, fix)
        if outcome is not UNUSED and not outcome.is_accepted:
            estimate.start_over(fix.t_ns)
            return outcome
        is_unconfirmed = situation.heading_unconfirmed and not _tells_course(fix, estimate.tuning)
        estimate.know(position_unconfirmed=False, heading_unconfirmed=is_unconfirmed)
        return outcome

    def _compared(self, estimate: Estimate, fix: Fix) -> Outcome:
        """The last comparison, which is the one that failed if one did."""
        situation, tuning = estimate.situation, estimate.tuning
        outcome = UNUSED
        if situation.position_unconfirmed and situation.plane is not None:
            place_m = situation.plane.to_plane(fix.lat_deg, fix.lon_deg)
            position = _position(estimate, place_m, fix.position_std_m)
            outcome = _compare(estimate, position, fix.t_ns, tuning.reacquire_probability)
            if not outcome.is_accepted:
                return outcome
        if situation.heading_unconfirmed and _tells_course(fix, tuning):
            return _compare(estimate, _course(estimate, fix), fix.t_ns, tuning.gate_probability)
        return outcome


def _compare(
    estimate: Estimate, measurement: Measurement, t_ns: int, probability: float
) -> Outcome:
    """Judged only: the aids of position and course use the fix, and tell of it under its name."""
    kept = measurement._replace(sensor=f"kept_{measurement.sensor}")
    policy = Policy(probability, update=_nothing, tells_accepted=False, reason=REASON)
    return try_measurement(estimate, kept, t_ns, policy)


def _nothing(_: Measurement) -> None:
    """A comparison corrects nothing."""


def _tells_course(fix: Fix, tuning: Tuning) -> bool:
    """Whether a fix has a course worth comparing a heading with."""
    if fix.course_rad is None or fix.speed_mps is None:
        return False
    return fix.speed_mps >= tuning.course_speed_min_mps


def _position(estimate: Estimate, place_m: tuple[float, float], std_m: float) -> Measurement:
    slow_std_m = estimate.filter.slow_std_m(std_m)
    white_std_m = math.sqrt(std_m**2 - slow_std_m**2)
    return measurements.position(estimate.filter.x, *place_m, slow_std_m, white_std_m)


def _course(estimate: Estimate, fix: Fix) -> Measurement:
    doppler_rad = fix.course_std_rad or fix.speed_std_mps / (fix.speed_mps or math.inf)
    std_rad = math.hypot(doppler_rad, math.radians(COURSE_SLACK_DEG))
    return measurements.course(estimate.filter.x, fix.course_rad or 0.0, std_rad, 0.0)
