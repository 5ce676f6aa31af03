"""Pure: a gyro that becomes warmer or colder under way."""

import math

from wayline_fusion.filter.estimate import Estimate
from wayline_fusion.filter.gate import UNUSED, Outcome
from wayline_fusion.filter.states import States
from wayline_fusion.intake.events import GyroWarmed


class GyroWarmth:
    """The gyro's temperature under way (papers/001 has the bias depend on it).

    Starts: with the second temperature. Goes on: each change that is told doubts the bias by what
    warmth does to it, beside its walk. Stops: without a temperature. Resets: nothing.
    """

    def __init__(self) -> None:
        self.evidence = None

    def take(self, estimate: Estimate, warmed: GyroWarmed) -> Outcome:
        """Doubt the bias."""
        drift = math.radians(estimate.tuning.gyro_bias_drift_degps_per_c)
        estimate.filter.inflate_std(States.GYRO_BIAS, drift * warmed.warmer_c)
        return UNUSED
