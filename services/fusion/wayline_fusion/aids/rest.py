"""Pure: a vehicle that stands: its speed is zero, and its gyro reads the bias."""

import math

import msgspec

from wayline.agreement import Agreement, lasted_s, rejected
from wayline_fusion.filter import measurements
from wayline_fusion.filter.estimate import Estimate
from wayline_fusion.filter.gate import UNUSED, Outcome, Policy, try_measurement
from wayline_fusion.filter.states import States
from wayline_fusion.intake.events import Elapsed

STILL_NS = 100_000_000
"""At rest the gyro is averaged over a step."""
REST_CORRELATION_S = 10.0
"""At rest a coarse gyro stays in one of its steps for so long."""


class RestEvidence(msgspec.Struct, frozen=True):
    """What earlier readings at rest have shown."""

    rejected: Agreement | None = None


class Rest:
    """Zero velocity, and the gyro's reading at it.

    Starts: wheels at zero for `standstill_after_s`. Goes on: at each step of time. Stops: a wheel
    turns, or the wheels fall silent; a reading that is too far from the bias is rejected. Resets:
    rejected for `bias_relock_after_s` the bias is another one, and is learned anew.
    """

    def __init__(self) -> None:
        self.evidence = RestEvidence()

    def take(self, estimate: Estimate, elapsed: Elapsed) -> Outcome:
        """Hold a vehicle that stands; one that drives is left alone."""
        if not estimate.standing:
            return UNUSED
        kalman, tuning = estimate.filter, estimate.tuning
        kalman.correct(measurements.still(kalman.x, tuning.standstill_std_mps))
        turned_rad = estimate.gyro.turned_rad(elapsed.t_ns - STILL_NS, elapsed.t_ns)
        if turned_rad is None:
            return UNUSED
        still_s = STILL_NS * 1e-9
        # at rest a coarse gyro reads the same step all the time
        rounding_radps = estimate.gyro_rounding_radps * math.sqrt(REST_CORRELATION_S / still_s)
        std_radps = math.hypot(math.radians(tuning.standstill_gyro_std_degps), rounding_radps)
        measurement = measurements.still_rate(kalman.x, turned_rad / still_s, std_radps)
        streak = self.evidence.rejected
        if lasted_s(streak, elapsed.t_ns) >= tuning.bias_relock_after_s:
            # another gyro, or one that was switched off and on
            kalman.reset_std(States.GYRO_BIAS, math.radians(tuning.gyro_bias_initial_std_degps))
            estimate.tell("standstill_gyro", elapsed.t_ns, "another bias for long; learned anew")
        policy = Policy(tuning.gate_probability, tells_accepted=False)
        outcome = try_measurement(estimate, measurement, elapsed.t_ns, policy)
        streak = None if outcome.is_accepted else rejected(streak, elapsed.t_ns)
        self.evidence = RestEvidence(streak)
        return outcome
