"""Pure: courses of fixes: they correct the heading, or it starts from them."""

import math

import msgspec

from wayline.agreement import Agreement, Off, rejected
from wayline.likelihood import Floats, Measurement, weighed
from wayline_fusion.filter import measurements
from wayline_fusion.filter.estimate import Estimate, Turn
from wayline_fusion.filter.gate import UNUSED, Outcome, Policy, try_measurement
from wayline_fusion.filter.situation import TakenCourse
from wayline_fusion.filter.states import States
from wayline_fusion.intake.events import GpsCourse

NOISE_FACTOR_MIN = 0.3
"""Doppler is no better than a third of the variance that is claimed."""
BIAS_DOUBT_FACTOR = 3.0
"""A course that had to be set says that the bias is known less well than it seemed; once more, and
again so."""
UNTIMED_STD_RAD = math.radians(10.0)
"""Of a course that is told without a speed, as position reports have it."""
LIKELY_PROBABILITY = 0.95
"""A single course may be off by degrees among many that are not; beside a gyro one less likely than
this counts for less, so that the way since the last fix is not bent by it."""
AGREEING_SHARE = 0.5
"""Rejected courses agree when none is off by less than this share of the one before; while the
heading is wrong and the vehicle turns they may be off by more."""


class CourseEvidence(msgspec.Struct, frozen=True):
    """What earlier courses have shown."""

    agreement: Agreement | None = None
    """Of those that were rejected, in radians from the heading."""


class Course:
    """Courses over ground of fixes.

    Starts: the first one at speed sets the heading. Goes on: each likely one corrects, with a
    std that grows in turns; beside a gyro one less likely than 95 % counts for less. Stops: below
    `course_speed_min_mps` a course is noise; an unlikely one is rejected. Resets: rejected ones
    that are off to one side for `course_relock_after_s` set the heading anew, the gyro's bias and
    the way since are doubted.
    """

    def __init__(self, turn: Turn) -> None:
        self.evidence = CourseEvidence()
        self._turn = turn

    def take(self, estimate: Estimate, course: GpsCourse) -> Outcome:
        """Correct the heading with a course, or start from it; a crawl has none worth it."""
        tuning, x = estimate.tuning, estimate.filter.x
        course = _timed(estimate, course)
        speed_mps = course.speed_mps
        if speed_mps is None or speed_mps < tuning.course_speed_min_mps:
            return UNUSED
        rate_radps = estimate.gyro.rate_radps(course.t_ns)
        rate_radps = 0.0 if rate_radps is None else rate_radps - float(x[States.GYRO_BIAS])
        std_rad = _std_rad(estimate, course, speed_mps, rate_radps)
        backwards_rad = math.pi if x[States.WHEEL_SPEED] < 0.0 else 0.0
        if not estimate.situation.heading_known:
            start_rad = max(std_rad, math.radians(tuning.heading_start_std_deg))
            estimate.filter.reset_heading(course.course_rad + backwards_rad, start_rad)
            estimate.know(heading_known=True)
            return UNUSED
        measurement = measurements.course(x, course.course_rad, std_rad, rate_radps)
        _learn_doppler(estimate, course, speed_mps, measurement)
        self._bend_way(estimate, course.t_ns, float(measurement.y[0]))

        def second_look(unlikely: Measurement) -> bool:
            before = estimate.situation.course
            since_ns = None if before is None else before.t_ns
            return self._turn(estimate, float(unlikely.y[0]), speed_mps, since_ns)

        turns_told = estimate.gyro.covers(course.t_ns)
        look = None if turns_told else second_look
        weigh = _weighed if turns_told else None
        policy = Policy(tuning.gate_probability, second_look=look, weigh=weigh)
        outcome = try_measurement(estimate, measurement, course.t_ns, policy)
        if outcome.is_accepted:
            self.evidence = CourseEvidence()
            heading_rad = course.course_rad + backwards_rad
            estimate.know(course=TakenCourse(course.t_ns, heading_rad, std_rad))
        else:
            self._wait(estimate, course.t_ns, float(outcome.off[0]))
        return outcome

    def _bend_way(self, estimate: Estimate, t_ns: int, off_rad: float) -> None:
        """Where no gyro has told of a turn, the way since the last course was no straight line."""
        before = estimate.situation.course
        if before is not None and not estimate.gyro.covers(t_ns):
            since_ns = max(before.t_ns, estimate.situation.accepted_fix_ns or 0)
            estimate.filter.inflate_arc(off_rad, (t_ns - since_ns) * 1e-9)

    def _wait(self, estimate: Estimate, t_ns: int, off_rad: float) -> None:
        """Remember a rejected course; believe it when others have agreed for long enough."""
        agreement = rejected(
            self.evidence.agreement, t_ns, (off_rad,), are_alike, estimate.rejected_forgotten_ns
        )
        self.evidence = CourseEvidence(agreement)
        if agreement.agreed_s >= estimate.tuning.course_relock_after_s:
            self.evidence = CourseEvidence()
            _turn_to_course(estimate, t_ns, off_rad, agreement.agreed_s)


def are_alike(before: Off, off: Off) -> bool:
    """Whether two courses are off to one side; noise is to both, now more and now less."""
    (before_rad,), (off_rad,) = before, off
    to_one_side = off_rad * before_rad > 0.0
    return to_one_side and abs(off_rad) >= AGREEING_SHARE * abs(before_rad)


def _turn_to_course(estimate: Estimate, t_ns: int, off_rad: float, agreed_s: float) -> None:
    """Courses have agreed for long on another heading: it, the way since and the bias are wrong."""
    kalman, tuning = estimate.filter, estimate.tuning
    # those that agree differ from each other by up to half of it
    kalman.reset_heading(float(kalman.x[States.HEADING]) + off_rad, 0.5 * abs(off_rad))
    across_mps = 2.0 * kalman.speed_mps * math.sin(0.5 * off_rad)
    kalman.inflate_position(across_mps * agreed_s)
    bias_std = BIAS_DOUBT_FACTOR * kalman.std(States.GYRO_BIAS)
    most = math.radians(tuning.gyro_bias_initial_std_degps)
    kalman.reset_std(States.GYRO_BIAS, min(bias_std, most))
    estimate.tell("gps_course", t_ns, "another heading for long; set to the course")


def _learn_doppler(
    estimate: Estimate, course: GpsCourse, speed_mps: float, measurement: Measurement
) -> None:
    """Across the direction of travel Doppler is as noisy as along it."""
    if course.std_rad is not None or not estimate.gyro.covers(course.t_ns):
        return
    claimed = (_doppler_mps(estimate, course) / speed_mps) ** 2
    noise = estimate.learned.doppler_noise
    other = float(measurement.R[0, 0]) - noise.factor * claimed
    predicted = float(estimate.filter.expected(measurement)[0, 0]) + other
    square = float(measurement.y[0]) ** 2
    estimate.learn(doppler_noise=noise.learned(square, predicted, claimed, NOISE_FACTOR_MIN))


def _timed(estimate: Estimate, course: GpsCourse) -> GpsCourse:
    """A course that is told without a speed, with the one believed; a tracker's may be old."""
    if course.speed_mps is not None:
        return course
    std_rad = max(course.std_rad or 0.0, UNTIMED_STD_RAD)
    speed_mps = abs(estimate.filter.speed_mps)
    stds_mps = course.speed_std_mps, course.own_speed_std_mps
    return GpsCourse(course.t_ns, course.course_rad, std_rad, speed_mps, *stds_mps)


def _std_rad(estimate: Estimate, course: GpsCourse, speed_mps: float, rate_radps: float) -> float:
    """Doppler across the direction of travel, mounting, and what turning adds."""
    tuning = estimate.tuning
    noise = math.sqrt(estimate.learned.doppler_noise.factor)
    doppler_rad = course.std_rad or _doppler_mps(estimate, course) * noise / speed_mps
    turning_rad = rate_radps * (tuning.antenna_lever_m / speed_mps + tuning.gps_time_std_s)
    return math.hypot(doppler_rad, math.radians(tuning.gps_course_std_deg), turning_rad)


def _doppler_mps(estimate: Estimate, course: GpsCourse) -> float:
    """Across the direction of travel, before its noise was learned."""
    across_mps = abs(estimate.filter.speed_mps) * estimate.filter.std(States.HEADING)
    is_better = across_mps > course.own_speed_std_mps
    return course.own_speed_std_mps if is_better else course.speed_std_mps


def _weighed(measurement: Measurement, expected: Floats) -> Measurement:
    """One that is unlikely beside the gyro counts for as much less."""
    return weighed(measurement, expected, LIKELY_PROBABILITY)
