"""Pure: air pressures, as altitudes of the standard atmosphere."""

import math
from typing import ClassVar

import msgspec

from wayline.agreement import Agreement, lasted_s, rejected
from wayline.noise_scale import NoiseScale
from wayline.vertical.trust import PRESSURE_FACTOR_MIN
from wayline_fusion.filter.gate import UNUSED, Outcome, Policy, try_measurement
from wayline_fusion.filter.vertical import VerticalEstimate
from wayline_fusion.intake.events import Pressure


class PressureEvidence(msgspec.Struct, frozen=True):
    """What earlier pressures have shown."""

    noise: NoiseScale = NoiseScale()
    """Of wind and steps, on the variance that is claimed."""
    rejected: Agreement | None = None


class AirPressure:
    """Barometric altitudes.

    Starts: the first one after an altitude of a fix; where no fix is to be asked, it tells the
    altitude itself, as well as the weather allows. Goes on: each likely one corrects, and teaches
    how noisy the air is. Stops: an unlikely one is rejected: a door, the gust of a tunnel. Resets:
    rejected for `baro_relock_after_s`, the bias is another one.
    """

    sensor: ClassVar[str] = "barometer"

    def __init__(self) -> None:
        self.evidence = PressureEvidence()

    def take(self, estimate: VerticalEstimate, pressure: Pressure) -> Outcome:
        """Correct with a barometric altitude."""
        tuning, kalman, noise = estimate.tuning, estimate.filter, self.evidence.noise
        std_m = math.sqrt(noise.factor) * pressure.std_m
        measurement = kalman.model.barometer(kalman.x, pressure.alt_m, std_m)
        if not estimate.known:
            if "gps" in tuning.vertical_sensors:
                return UNUSED
            estimate.correct(measurement)
            estimate.known = True
            return UNUSED
        streak = self.evidence.rejected
        if lasted_s(streak, pressure.t_ns) >= tuning.baro_relock_after_s:
            kalman.inflate_bias(float(measurement.y[0]))
        policy = Policy(tuning.gate_probability)
        outcome = try_measurement(estimate, measurement, pressure.t_ns, policy)
        square, predicted = float(outcome.off[0]) ** 2, float(outcome.expected[0, 0])
        noise = noise.learned(square, predicted, pressure.std_m**2, PRESSURE_FACTOR_MIN)
        if outcome.is_accepted:
            estimate.note_pressure()
            self.evidence = PressureEvidence(noise)
        else:
            self.evidence = PressureEvidence(noise, rejected(streak, pressure.t_ns))
        return outcome
