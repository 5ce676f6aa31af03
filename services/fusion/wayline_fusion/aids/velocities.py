"""Pure: speed and course of fixes, and what they teach of gyro and receiver."""

import math

from wayline_fusion.aids.manoeuvre import allow_manoeuvre
from wayline_fusion.evidence.bias_wander import Walk
from wayline_fusion.evidence.lockout import course_rejected
from wayline_fusion.evidence.streak import after, lasted_s
from wayline_fusion.filter import measurements
from wayline_fusion.filter.estimate import SCALE_UNKNOWN, SPEED_UNKNOWN_MPS, Estimate
from wayline_fusion.filter.gate import nis_of, threshold
from wayline_fusion.filter.measurements import Measurement
from wayline_fusion.filter.states import States
from wayline_fusion.intake.events import Fix

VELOCITY_FACTOR_MIN = 0.3
VELOCITY_FACTOR_MIN_ALONE = 1.0
"""Without wheels nothing but the vehicle's habits tells noise from driving."""
BIAS_DOUBT_FACTOR = 3.0
"""A course that had to be set says that the bias is known less well than it seemed; once more, and
again so."""


def take_speed(estimate: Estimate, fix: Fix, speed_mps: float) -> None:
    """Correct the speed, and learn how noisy the receiver's Doppler is."""
    memory, tuning = estimate.memory, estimate.tuning
    std_mps = fix.speed_std_mps * math.sqrt(memory.velocity_noise.factor)
    measurement = measurements.gps_speed(estimate.filter.x, speed_mps, std_mps)
    expected = estimate.filter.expected(measurement)
    if nis_of(measurement, expected) > threshold(1, tuning.gate_probability):
        _doubt_speed(estimate, measurement, fix.t_ns)
    is_accepted = estimate.gated(measurement, fix.t_ns)
    noise = memory.velocity_noise
    if speed_mps >= tuning.course_speed_min_mps:
        noise = noise.learned(
            float(measurement.y[0]) ** 2,
            float(expected[0, 0]),
            fix.speed_std_mps**2,
            VELOCITY_FACTOR_MIN if estimate.wheels_fresh else VELOCITY_FACTOR_MIN_ALONE,
        )
    estimate.remember(
        velocity_noise=noise,
        speed_accepted_ns=fix.t_ns if is_accepted else memory.speed_accepted_ns,
        speed_rejected=after(memory.speed_rejected, fix.t_ns, is_accepted=is_accepted),
    )


def _doubt_speed(estimate: Estimate, measurement: Measurement, t_ns: int) -> None:
    """Before an unlikely speed is rejected: what else it may mean."""
    memory, kalman = estimate.memory, estimate.filter
    rejected_s = lasted_s(memory.speed_rejected, t_ns)
    if estimate.wheels_fresh:
        if rejected_s >= estimate.tuning.speed_relock_after_s:
            kalman.stray(float(measurement.y[0]) * rejected_s)
            # other tyres, or a speed in another unit
            kalman.doubt(States.ODOMETER_SCALE, SCALE_UNKNOWN)
            estimate.tell("odometer", t_ns, "another scale for long; learned anew")
    elif rejected_s > 0.0:
        # two in a row, and nothing else tells the speed
        kalman.doubt(States.WHEEL_SPEED, SPEED_UNKNOWN_MPS)
    else:
        allow_manoeuvre(estimate, measurement, t_ns, memory.speed_accepted_ns)


def take_course(estimate: Estimate, fix: Fix, speed_mps: float) -> None:
    """Correct the heading with a course, or start from it; a crawl has none worth it."""
    tuning = estimate.tuning
    if fix.course_rad is None or speed_mps < tuning.course_speed_min_mps:
        return
    rate_radps = estimate.gyro.rate_radps(fix.t_ns)
    rate_radps = (
        0.0 if rate_radps is None else rate_radps - float(estimate.filter.x[States.GYRO_BIAS])
    )
    std_rad = _course_std_rad(estimate, fix, speed_mps, rate_radps)
    backwards_rad = math.pi if estimate.filter.x[States.WHEEL_SPEED] < 0.0 else 0.0
    if not estimate.memory.heading_known:
        start_rad = max(std_rad, math.radians(tuning.heading_start_std_deg))
        estimate.filter.turn_to(fix.course_rad + backwards_rad, start_rad)
        estimate.remember(heading_known=True)
        return
    measurement = measurements.course(estimate.filter.x, fix.course_rad, std_rad, rate_radps)
    _learn_doppler(estimate, fix, speed_mps, measurement)
    if estimate.gated(measurement, fix.t_ns):
        estimate.remember(course_lockout=None)
        _learn_wander(estimate, fix.t_ns, fix.course_rad + backwards_rad, std_rad)
        return
    off_rad = float(measurement.y[0])
    lockout = course_rejected(estimate.memory.course_lockout, fix.t_ns, off_rad)
    estimate.remember(course_lockout=lockout)
    if lockout.agreed_s >= tuning.course_relock_after_s:
        _turn_to_course(estimate, fix, off_rad, lockout.agreed_s)


def _turn_to_course(estimate: Estimate, fix: Fix, off_rad: float, agreed_s: float) -> None:
    """Courses have agreed for long on another heading: it, the way since and the bias are wrong."""
    kalman, tuning = estimate.filter, estimate.tuning
    # those that agree differ from each other by up to half of it
    kalman.turn_to(float(kalman.x[States.HEADING]) + off_rad, 0.5 * abs(off_rad))
    across_mps = 2.0 * kalman.speed_mps * math.sin(0.5 * off_rad)
    estimate.filter.stray(across_mps * agreed_s)
    bias_std = BIAS_DOUBT_FACTOR * kalman.std(States.GYRO_BIAS)
    most = math.radians(tuning.gyro_bias_initial_std_degps)
    kalman.doubt(States.GYRO_BIAS, min(bias_std, most))
    estimate.remember(course_lockout=None)
    estimate.tell("gps_course", fix.t_ns, "another heading for long; set to the course")


def _learn_wander(estimate: Estimate, t_ns: int, course_rad: float, std_rad: float) -> None:
    """Of the gyro's bias, from the heading that a fix tells."""
    memory, tuning, kalman = estimate.memory, estimate.tuning, estimate.filter
    turn_rad = estimate.gyro.angle_rad(t_ns)
    if turn_rad is None:
        estimate.remember(wander=memory.wander.forgotten())
        return
    walk = Walk(
        math.radians(tuning.gyro_bias_walk_degps_per_sqrt_s),
        estimate.driving_noise().turn_rad_per_sqrt_s,
        float(kalman.x[States.GYRO_BIAS]),
        float(kalman.x[States.GYRO_SCALE]),
        kalman.std(States.GYRO_SCALE),
    )
    estimate.remember(wander=memory.wander.noticed(t_ns, course_rad, std_rad, turn_rad, walk))


def _learn_doppler(
    estimate: Estimate, fix: Fix, speed_mps: float, measurement: Measurement
) -> None:
    """Across the direction of travel Doppler is as noisy as along it."""
    if fix.course_std_rad is not None or not estimate.gyro.covers(fix.t_ns):
        return
    claimed = (fix.speed_std_mps / speed_mps) ** 2
    noise = estimate.memory.velocity_noise
    other = float(measurement.R[0, 0]) - noise.factor * claimed
    estimate.remember(
        velocity_noise=noise.learned(
            float(measurement.y[0]) ** 2,
            float(estimate.filter.expected(measurement)[0, 0]) + other,
            claimed,
            VELOCITY_FACTOR_MIN,
        )
    )


def _course_std_rad(estimate: Estimate, fix: Fix, speed_mps: float, rate_radps: float) -> float:
    """Doppler across the direction of travel, mounting, and what turning adds."""
    tuning = estimate.tuning
    noise = math.sqrt(estimate.memory.velocity_noise.factor)
    doppler_rad = fix.course_std_rad or fix.speed_std_mps * noise / speed_mps
    turning_rad = rate_radps * (tuning.antenna_lever_m / speed_mps + tuning.gps_time_std_s)
    return math.hypot(doppler_rad, math.radians(tuning.gps_course_std_deg), turning_rad)
