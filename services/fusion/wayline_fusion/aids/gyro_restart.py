"""Pure: a gyro that was off and is now warmer or colder than when its bias was kept."""

import math

from wayline_fusion.filter.estimate import Estimate
from wayline_fusion.filter.gate import UNUSED, Outcome
from wayline_fusion.filter.states import States
from wayline_fusion.intake.events import GyroRestarted


class GyroRestart:
    """The gyro's temperature after a restart.

    Starts: with the first temperature, where one was kept. Goes on: never, it is told once. Stops:
    without a temperature. Resets: the bias is trusted less by what warmth does to it.
    """

    def __init__(self) -> None:
        self.evidence = None

    def take(self, estimate: Estimate, restarted: GyroRestarted) -> Outcome:
        """Doubt the bias that was kept."""
        drift = math.radians(estimate.tuning.gyro_bias_drift_degps_per_c)
        bias_std = math.hypot(estimate.filter.std(States.GYRO_BIAS), drift * restarted.warmer_c)
        estimate.filter.reset_std(States.GYRO_BIAS, bias_std)
        return UNUSED
