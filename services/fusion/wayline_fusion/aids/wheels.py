"""Pure: wheel speeds: what they tell and when they are not believed."""

import math
from typing import NamedTuple

import msgspec

from wayline.agreement import Agreement, lasted_s, rejected
from wayline.likelihood import Measurement
from wayline_fusion.filter import measurements
from wayline_fusion.filter.estimate import Estimate, Manoeuvre
from wayline_fusion.filter.gate import UNUSED, Outcome, Policy, try_measurement
from wayline_fusion.filter.horizontal import SCALE_UNKNOWN, SPEED_UNKNOWN_MPS
from wayline_fusion.filter.states import States
from wayline_fusion.intake.events import WheelSpeed

DOPPLER_FRESH_NS = 3_000_000_000
"""Older, the speed of a fix says nothing against wheels."""
NOISE_CORRELATION_NS = 100_000_000
"""Wheel speeds that come faster are wrong alike: rough roads, uneven teeth, filters."""
TRAPEZOID_NS = 1_000_000_000
"""Further apart, wheel speeds say too little of the way between them."""


class Rolled(NamedTuple):
    """A wheel speed, as measured, and the distance at its instant."""

    t_ns: int
    speed_mps: float
    distance_m: float


class WheelEvidence(msgspec.Struct, frozen=True):
    """What earlier wheel speeds have shown."""

    rolled: Rolled | None = None
    """The last one that was believed."""
    rejected: Agreement | None = None


class Wheels:
    """Wheel speeds.

    Starts: with the first one. Goes on: each likely one corrects, and two tell the way between
    them; while the vehicle stands a further zero says nothing new. Stops: one that no vehicle
    makes of the last is rejected: wheels that locked or spin. Resets: after
    `wheels_relock_after_s` the speed is free; while the receiver's speeds speak against them, after
    `speed_relock_after_s`, they have another scale.
    """

    def __init__(self, manoeuvre: Manoeuvre) -> None:
        self.evidence = WheelEvidence()
        self._manoeuvre = manoeuvre

    def take(self, estimate: Estimate, wheels: WheelSpeed) -> Outcome:
        """Correct with a wheel speed, unless no vehicle changes its speed like that."""
        is_still = wheels.speed_mps == 0.0
        if estimate.standing and not is_still:
            _pull_away(estimate, wheels.t_ns)
        estimate.know(wheels_ns=wheels.t_ns)
        if estimate.standing and is_still:
            rolled = Rolled(wheels.t_ns, 0.0, estimate.distance_m)
            self.evidence = msgspec.structs.replace(self.evidence, rolled=rolled)
            return UNUSED
        outcome = self._try(estimate, wheels)
        if not outcome.is_accepted:
            streak = rejected(self.evidence.rejected, wheels.t_ns)
            self.evidence = msgspec.structs.replace(self.evidence, rejected=streak)
            _turn(estimate)
        elif not is_still:
            _turn(estimate)
        elif estimate.situation.still_since_ns is None:
            estimate.know(still_since_ns=wheels.t_ns)
        return outcome

    def _try(self, estimate: Estimate, wheels: WheelSpeed) -> Outcome:
        std_mps = wheels.std_mps * self._oversampled(wheels.t_ns)
        measurement = measurements.odometer(estimate.filter.x, wheels.speed_mps, std_mps)
        if self.evidence.rejected is not None:
            self._doubt(estimate, wheels, measurement)

        def second_look(unlikely: Measurement) -> bool:
            rolled = self.evidence.rolled
            since_ns = rolled.t_ns if rolled else None
            is_first = lasted_s(self.evidence.rejected, wheels.t_ns) == 0.0
            return is_first and self._manoeuvre(estimate, unlikely, wheels.t_ns, since_ns)

        def update(likely: Measurement) -> None:
            self._roll(estimate, wheels)
            # a hard start or stop, which the filter is slow to believe, must not teach it a scale
            estimate.filter.consider(likely, States.ODOMETER_SCALE)

        probability = estimate.tuning.gate_probability
        policy = Policy(probability, second_look, update=update, tells_accepted=False)
        return try_measurement(estimate, measurement, wheels.t_ns, policy)

    def _oversampled(self, t_ns: int) -> float:
        """How much more noise each of many speeds has, so that together they tell no more."""
        before = self.evidence.rolled
        if before is None or not 0 < t_ns - before.t_ns < NOISE_CORRELATION_NS:
            return 1.0
        return math.sqrt(NOISE_CORRELATION_NS / (t_ns - before.t_ns))

    def _doubt(self, estimate: Estimate, wheels: WheelSpeed, measurement: Measurement) -> None:
        """After long enough what spoke against the wheels is doubted: the speed, or their scale."""
        kalman, tuning = estimate.filter, estimate.tuning
        rejected_s = lasted_s(self.evidence.rejected, wheels.t_ns)
        if self._is_doppler_believed(estimate):
            if rejected_s >= tuning.speed_relock_after_s and _is_driving(estimate, wheels):
                kalman.reset_scale(wheels.speed_mps, SCALE_UNKNOWN)
                kalman.reset_std(States.WHEEL_SPEED, SPEED_UNKNOWN_MPS)
                estimate.tell("odometer", wheels.t_ns, "another scale for long; learned anew")
        elif rejected_s >= tuning.wheels_relock_after_s:
            kalman.inflate_position(float(measurement.y[0]) * rejected_s)
            kalman.reset_std(States.WHEEL_SPEED, SPEED_UNKNOWN_MPS)
            estimate.know(still_since_ns=None)

    def _is_doppler_believed(self, estimate: Estimate) -> bool:
        """While the receiver's speeds pass, the wheels are wrong; in a tunnel none do."""
        streak, speed_ns = self.evidence.rejected, estimate.situation.speed_accepted_ns
        if streak is None or speed_ns is None:
            return False
        return speed_ns > streak.first_ns and estimate.t_ns - speed_ns <= DOPPLER_FRESH_NS

    def _roll(self, estimate: Estimate, wheels: WheelSpeed) -> None:
        """Two wheel speeds tell the way between them better than a prediction from the first."""
        before = self.evidence.rolled
        if before is not None and wheels.t_ns - before.t_ns <= TRAPEZOID_NS:
            elapsed_s = (wheels.t_ns - before.t_ns) * 1e-9
            measured_m = 0.5 * abs(before.speed_mps + wheels.speed_mps) * elapsed_s
            scale = float(estimate.filter.x[States.ODOMETER_SCALE])
            estimate.distance_m = before.distance_m + scale * measured_m
        self.evidence = WheelEvidence(Rolled(wheels.t_ns, wheels.speed_mps, estimate.distance_m))


def _turn(estimate: Estimate) -> None:
    """The wheels do not stand, or it is not known."""
    if estimate.situation.still_since_ns is not None:
        estimate.know(still_since_ns=None)


def _is_driving(estimate: Estimate, wheels: WheelSpeed) -> bool:
    """Wheels and the filter say so, if not how fast; a sensor that is stuck at 0 has no scale."""
    least_mps = estimate.tuning.course_speed_min_mps
    return min(abs(wheels.speed_mps), abs(estimate.filter.speed_mps)) >= least_mps


def _pull_away(estimate: Estimate, t_ns: int) -> None:
    """Since the last wheel speed it was held still, yet may have driven off."""
    held_s = (t_ns - (estimate.situation.wheels_ns or t_ns)) * 1e-9
    gained_mps = estimate.tuning.acceleration_noise_mps_per_sqrt_s * math.sqrt(held_s)
    estimate.filter.reset_std(States.WHEEL_SPEED, gained_mps)
