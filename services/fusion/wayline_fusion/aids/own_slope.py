"""Pure: the slope that the vehicle itself reports."""

import math
from typing import ClassVar

import msgspec

from wayline.noise_scale import NoiseScale
from wayline.vertical.trust import TORQUE_FACTOR_MIN
from wayline_fusion.filter.gate import UNUSED, Outcome, Policy, try_measurement
from wayline_fusion.filter.vertical import VerticalEstimate
from wayline_fusion.intake.events import ReportedSlope


class OwnSlopeEvidence(msgspec.Struct, frozen=True):
    """What earlier reports have shown."""

    noise: NoiseScale = NoiseScale()
    """Of the variance that is configured."""


class VehicleSlope:
    """Slopes that the vehicle reports.

    Starts: once an altitude is known, or at once where no altimeter is to be asked. Goes on: each
    likely one corrects, and teaches how noisy they are. Stops: an unlikely one is rejected; while
    torques are used none is, because the vehicle makes its slope of the same torque. Resets: never,
    the bias wanders by itself.
    """

    sensor: ClassVar[str] = "vehicle_slope"

    def __init__(self) -> None:
        self.evidence = OwnSlopeEvidence()

    def take(self, estimate: VerticalEstimate, report: ReportedSlope) -> Outcome:
        """Correct with a report."""
        tuning, kalman, noise = estimate.tuning, estimate.filter, self.evidence.noise
        if not estimate.known:
            if {"gps", "barometer"} & set(tuning.vertical_sensors):
                return UNUSED
            estimate.known = True
        if estimate.torque_fresh:
            return UNUSED
        claimed = tuning.vehicle_slope_std_pct / 100.0 / math.sqrt(report.length_s)
        std = math.sqrt(noise.factor) * claimed
        measurement = kalman.model.own_slope(kalman.x, report.slope, std)
        policy = Policy(tuning.gate_probability)
        outcome = try_measurement(estimate, measurement, report.t_ns, policy)
        square, predicted = float(outcome.off[0]) ** 2, float(outcome.expected[0, 0])
        noise = noise.learned(square, predicted, claimed**2, TORQUE_FACTOR_MIN)
        self.evidence = OwnSlopeEvidence(noise)
        return outcome
