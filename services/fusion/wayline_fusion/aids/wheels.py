"""Pure: wheel speeds, and rest: what they tell and when they are not believed."""

import math

from wayline_fusion.aids.manoeuvre import allow_manoeuvre
from wayline_fusion.evidence.memory import Rolled
from wayline_fusion.evidence.streak import after, lasted_s
from wayline_fusion.filter import measurements
from wayline_fusion.filter.estimate import SCALE_UNKNOWN, SPEED_UNKNOWN_MPS, Estimate
from wayline_fusion.filter.gate import judge, nis_of, threshold
from wayline_fusion.filter.measurements import Measurement
from wayline_fusion.filter.states import States
from wayline_fusion.intake.events import Step, WheelSpeed

DOPPLER_FRESH_NS = 3_000_000_000
"""Older, the speed of a fix says nothing against wheels."""
NOISE_CORRELATION_NS = 100_000_000
"""Wheel speeds that come faster are wrong alike: rough roads, uneven teeth, filters."""
TRAPEZOID_NS = 1_000_000_000
"""Further apart, wheel speeds say too little of the way between them."""
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
        estimate.remember(rolled=Rolled(event.t_ns, 0.0, estimate.distance_m))
        return
    std_mps = event.std_mps * _oversampled(estimate, event.t_ns)
    measurement = measurements.odometer(estimate.filter.x, event.speed_mps, std_mps)
    if not _believe(estimate, event, measurement):
        streak = after(estimate.memory.wheels_rejected, event.t_ns, is_accepted=False)
        estimate.remember(wheels_rejected=streak, still_since_ns=None)
        return
    _roll(estimate, event)
    still_since_ns = estimate.memory.still_since_ns or event.t_ns
    estimate.remember(
        wheels_rejected=None,
        still_since_ns=still_since_ns if event.speed_mps == 0.0 else None,
    )
    # a hard start or stop, which the filter is slow to believe, is not to teach it a scale
    estimate.filter.consider(measurement, States.ODOMETER_SCALE)


def _oversampled(estimate: Estimate, t_ns: int) -> float:
    """How much more noise each of many speeds has, so that together they tell no more."""
    before = estimate.memory.rolled
    if before is None or not 0 < t_ns - before.t_ns < NOISE_CORRELATION_NS:
        return 1.0
    return math.sqrt(NOISE_CORRELATION_NS / (t_ns - before.t_ns))


def _believe(estimate: Estimate, event: WheelSpeed, measurement: Measurement) -> bool:
    """False of wheels that locked or spin, which is told; else what spoke against them is doubted.

    That is the acceleration, or after long enough the speed or the scale.
    """
    memory, kalman = estimate.memory, estimate.filter
    rejected_s = lasted_s(memory.wheels_rejected, event.t_ns)
    if _is_doppler_believed(estimate):
        if rejected_s >= estimate.tuning.speed_relock_after_s and _is_driving(estimate, event):
            kalman.rescale(event.speed_mps, SCALE_UNKNOWN)
            kalman.doubt(States.WHEEL_SPEED, SPEED_UNKNOWN_MPS)
            estimate.tell("odometer", event.t_ns, "another scale for long; learned anew")
            return True
    elif rejected_s >= estimate.tuning.wheels_relock_after_s:
        kalman.stray(float(measurement.y[0]) * rejected_s)
        kalman.doubt(States.WHEEL_SPEED, SPEED_UNKNOWN_MPS)
        estimate.remember(still_since_ns=None)
        return True
    nis = nis_of(measurement, kalman.expected(measurement))
    if nis <= threshold(1, estimate.tuning.gate_probability):
        return True
    since_ns = memory.rolled.t_ns if memory.rolled else None
    if rejected_s == 0.0 and allow_manoeuvre(estimate, measurement, event.t_ns, since_ns):
        return True
    probability = estimate.tuning.gate_probability
    estimate.verdicts.append(judge("odometer", event.t_ns, nis, 1, probability))
    return False


def _is_doppler_believed(estimate: Estimate) -> bool:
    """While the receiver's speeds pass, it is the wheels that are wrong; in a tunnel none do."""
    streak, speed_ns = estimate.memory.wheels_rejected, estimate.memory.speed_accepted_ns
    if streak is None or speed_ns is None:
        return False
    return speed_ns > streak.since_ns and estimate.t_ns - speed_ns <= DOPPLER_FRESH_NS


def _is_driving(estimate: Estimate, event: WheelSpeed) -> bool:
    """Wheels and the filter say so, if not how fast; a sensor that is stuck at 0 has no scale."""
    least_mps = estimate.tuning.course_speed_min_mps
    return min(abs(event.speed_mps), abs(estimate.filter.speed_mps)) >= least_mps


def _roll(estimate: Estimate, event: WheelSpeed) -> None:
    """Two wheel speeds tell the way between them better than what was predicted from the first."""
    before = estimate.memory.rolled
    if before is not None and event.t_ns - before.t_ns <= TRAPEZOID_NS:
        elapsed_s = (event.t_ns - before.t_ns) * 1e-9
        measured_m = 0.5 * abs(before.speed_mps + event.speed_mps) * elapsed_s
        scale = float(estimate.filter.x[States.ODOMETER_SCALE])
        estimate.distance_m = before.distance_m + scale * measured_m
    estimate.remember(rolled=Rolled(event.t_ns, event.speed_mps, estimate.distance_m))


def _pull_away(estimate: Estimate, t_ns: int) -> None:
    """Since the last wheel speed it was held still, yet may have driven off."""
    held_s = (t_ns - (estimate.memory.wheels_ns or t_ns)) * 1e-9
    gained_mps = estimate.tuning.acceleration_noise_mps_per_sqrt_s * math.sqrt(held_s)
    estimate.filter.doubt(States.WHEEL_SPEED, gained_mps)


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
    streak = estimate.memory.still_rate_rejected
    if lasted_s(streak, event.t_ns) >= tuning.bias_relock_after_s:
        # another gyro, or one that was switched off and on
        estimate.filter.doubt(States.GYRO_BIAS, math.radians(tuning.gyro_bias_initial_std_degps))
        estimate.tell("standstill_gyro", event.t_ns, "another bias for long; learned anew")
    is_accepted = estimate.gated(measurement, event.t_ns, is_silent=True)
    estimate.remember(still_rate_rejected=after(streak, event.t_ns, is_accepted=is_accepted))
