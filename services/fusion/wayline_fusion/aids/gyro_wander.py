"""Pure: what the courses teach of how the gyro's bias wanders."""

import math

from wayline_fusion.evidence.bias_wander import Walk
from wayline_fusion.filter.estimate import Estimate
from wayline_fusion.filter.gate import UNUSED, Outcome
from wayline_fusion.filter.states import States
from wayline_fusion.intake.events import GyroCheck


class GyroWander:
    """The gyro's measured turn against the courses that were believed.

    Starts: with the first course that corrected. Goes on: with each one. Stops: without a gyro,
    and the courses before the gap are forgotten. Resets: never; what was learned fades.
    """

    def __init__(self) -> None:
        self.evidence = None

    def take(self, estimate: Estimate, check: GyroCheck) -> Outcome:
        """Learn from the heading that a course has just told; the state is not touched."""
        course, wander = estimate.situation.course, estimate.learned.wander
        if course is None or course.t_ns != check.t_ns:
            return UNUSED
        turn_rad = estimate.gyro.angle_rad(check.t_ns)
        if turn_rad is None:
            estimate.learn(wander=wander.forgotten())
            return UNUSED
        kalman = estimate.filter
        walk = Walk(
            math.radians(estimate.tuning.gyro_bias_walk_degps_per_sqrt_s),
            estimate.driving_noise().turn_rad_per_sqrt_s,
            float(kalman.x[States.GYRO_BIAS]),
            float(kalman.x[States.GYRO_SCALE]),
            kalman.std(States.GYRO_SCALE),
        )
        noticed = wander.noticed(check.t_ns, course.heading_rad, course.std_rad, turn_rad, walk)
        estimate.learn(wander=noticed)
        return UNUSED
