"""Pure: speeds of fixes, and what they teach of the receiver."""

import math

import msgspec

from wayline.agreement import Agreement, lasted_s, rejected
from wayline.likelihood import Measurement
from wayline_fusion.filter import measurements
from wayline_fusion.filter.estimate import Estimate, Manoeuvre
from wayline_fusion.filter.gate import Outcome, Policy, try_measurement
from wayline_fusion.filter.horizontal import SCALE_UNKNOWN, SPEED_UNKNOWN_MPS
from wayline_fusion.filter.states import States
from wayline_fusion.intake.events import GpsSpeed

NOISE_FACTOR_MIN = 0.3
"""Doppler is no better than a third of the variance that is claimed."""
NOISE_FACTOR_MIN_ALONE = 1.0
"""Without wheels nothing but the vehicle's habits tells noise from driving."""


class SpeedEvidence(msgspec.Struct, frozen=True):
    """What earlier speeds have shown."""

    rejected: Agreement | None = None


class Speed:
    """Speeds of fixes, by Doppler or from where the fixes have moved.

    Starts: with the first one. Goes on: each likely one corrects, and beside wheels teaches their
    scale. Stops: an unlikely one is rejected, unless tyres could have made it. Resets: rejected
    for `speed_relock_after_s` beside wheels, they say that the wheels have another scale; two in a
    row without wheels set the speed free.
    """

    def __init__(self, manoeuvre: Manoeuvre) -> None:
        self.evidence = SpeedEvidence()
        self._manoeuvre = manoeuvre

    def take(self, estimate: Estimate, speed: GpsSpeed) -> Outcome:
        """Correct the speed, and learn how noisy the receiver's Doppler is."""
        noise, tuning = estimate.learned.doppler_noise, estimate.tuning
        if not estimate.wheels_fresh and estimate.filter.x[States.WHEEL_SPEED] < 0.0:
            estimate.filter.reset_speed()
        std_mps = speed.std_mps * math.sqrt(noise.factor)
        measurement = measurements.gps_speed(estimate.filter.x, speed.speed_mps, std_mps)

        def second_look(unlikely: Measurement) -> bool:
            self._doubt(estimate, unlikely, speed.t_ns)
            return True

        policy = Policy(tuning.gate_probability, second_look=second_look)
        outcome = try_measurement(estimate, measurement, speed.t_ns, policy)
        if speed.speed_mps >= tuning.course_speed_min_mps:
            least = NOISE_FACTOR_MIN if estimate.wheels_fresh else NOISE_FACTOR_MIN_ALONE
            square, predicted = float(outcome.off[0]) ** 2, float(outcome.expected[0, 0])
            estimate.learn(doppler_noise=noise.learned(square, predicted, speed.std_mps**2, least))
        if outcome.is_accepted:
            self.evidence = SpeedEvidence()
            estimate.know(speed_accepted_ns=speed.t_ns)
        else:
            streak, forgotten_ns = self.evidence.rejected, estimate.rejected_forgotten_ns
            self.evidence = SpeedEvidence(
                rejected(streak, speed.t_ns, forgotten_after_ns=forgotten_ns)
            )
        return outcome

    def _doubt(self, estimate: Estimate, measurement: Measurement, t_ns: int) -> None:
        """Before an unlikely speed is rejected: what else it may mean."""
        kalman = estimate.filter
        rejected_s = lasted_s(self.evidence.rejected, t_ns, estimate.rejected_forgotten_ns)
        if estimate.wheels_fresh:
            if rejected_s >= estimate.tuning.speed_relock_after_s:
                kalman.inflate_position(float(measurement.y[0]) * rejected_s)
                # other tyres, or a speed in another unit
                kalman.reset_std(States.ODOMETER_SCALE, SCALE_UNKNOWN)
                estimate.tell("odometer", t_ns, "another scale for long; learned anew")
        elif rejected_s > 0.0:
            # two in a row, and nothing else tells the speed
            kalman.reset_std(States.WHEEL_SPEED, SPEED_UNKNOWN_MPS)
        else:
            self._manoeuvre(estimate, measurement, t_ns, estimate.situation.speed_accepted_ns)
