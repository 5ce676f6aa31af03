"""Pure: wheel speeds, and rest: what they tell and when they are not believed."""

import math

from wayline_fusion import measurements
from wayline_fusion.estimate import SPEED_UNKNOWN_MPS, Estimate, has_lasted, since
from wayline_fusion.events import Step, WheelSpeed
from wayline_fusion.gate import judge, nis_of, threshold
from wayline_fusion.states import States

STILL_NS = 100_000_000
"""At rest the gyro is averaged over a step."""
REST_CORRELATION_S = 10.0
"""At rest a coarse gyro stays in one of its steps for so long."""


def take_wheel_speed(estimate: Estimate, event: WheelSpeed) -> None:
    """Correct with a wheel speed, unless no vehicle changes its speed like that."""
    if estimate.standing and event.speed_mps != 0.0:
        _pull_away(estimate, event.t_ns)
    estimate.remember(wheels_ns=event.t_ns)
    if estimate.standing and event.speed_mps == 0.0:
        return
    measurement = measurements.odometer(estimate.filter.x, event.speed_mps, event.std_mps)
    since_ns = estimate.memory.wheels_rejected_since_ns
    if has_lasted(since_ns, event.t_ns, estimate.tuning.wheels_relock_after_s):
        estimate.strayed(float(measurement.y[0]), since_ns, event.t_ns)
        estimate.filter.doubt(States.SPEED, SPEED_UNKNOWN_MPS)
        estimate.remember(still_since_ns=None)
    nis = nis_of(measurement, estimate.filter.expected(measurement))
    if nis > threshold(1, estimate.tuning.gate_probability):
        verdict = judge("odometer", event.t_ns, nis, 1, estimate.tuning.gate_probability)
        estimate.verdicts.append(verdict)
        estimate.remember(wheels_rejected_since_ns=since_ns or event.t_ns, still_since_ns=None)
        return
    still_since_ns = estimate.memory.still_since_ns or event.t_ns
    estimate.remember(
        wheels_rejected_since_ns=None,
        still_since_ns=still_since_ns if event.speed_mps == 0.0 else None,
    )
    estimate.filter.correct(measurement)


def _pull_away(estimate: Estimate, t_ns: int) -> None:
    """Since the last wheel speed it was held still, yet may have driven off."""
    held_s = (t_ns - (estimate.memory.wheels_ns or t_ns)) * 1e-9
    gained_mps = estimate.tuning.acceleration_noise_mps_per_sqrt_s * math.sqrt(held_s)
    estimate.filter.doubt(States.SPEED, gained_mps)


def stand_still(estimate: Estimate, event: Step) -> None:
    """Zero velocity, and the gyro reads its bias."""
    tuning = estimate.tuning
    estimate.filter.correct(measurements.still(estimate.filter.x, tuning.standstill_std_mps))
    turned_rad = estimate.gyro.turned_rad(event.t_ns - STILL_NS, event.t_ns)
    if turned_rad is None:
        return
    still_s = STILL_NS * 1e-9
    # at rest a coarse gyro reads the same step all the time
    rounding_radps = estimate.gyro_rounding_radps * math.sqrt(REST_CORRELATION_S / still_s)
    std_radps = math.hypot(math.radians(tuning.standstill_gyro_std_degps), rounding_radps)
    rate_radps = turned_rad / still_s
    measurement = measurements.still_rate(estimate.filter.x, rate_radps, std_radps)
    since_ns = estimate.memory.still_rate_rejected_since_ns
    if has_lasted(since_ns, event.t_ns, tuning.bias_relock_after_s):
        # another gyro, or one that was switched off and on
        estimate.filter.doubt(States.GYRO_BIAS, math.radians(tuning.gyro_bias_initial_std_degps))
        estimate.tell("standstill_gyro", event.t_ns, "another bias for long; learned anew")
    is_accepted = estimate.gated(measurement, event.t_ns, is_silent=True)
    estimate.remember(still_rate_rejected_since_ns=since(is_accepted, since_ns, event.t_ns))
