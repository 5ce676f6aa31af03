"""Pure: how much warmer a gyro has become under way, or colder."""

import math

from wayline.messages import Gyro
from wayline_fusion.intake.events import GyroWarmed

SMOOTHED_S = 30.0
"""Warmth is slow; a sensor's noise and steps are not."""
TOLD_C = 1.0
"""A change as large is told."""


class Warmth:
    """Follows the gyro's temperature."""

    def __init__(self) -> None:
        self._t_ns = 0
        self._mean_c: float | None = None
        self._told_c = 0.0

    def change(self, gyro: Gyro) -> GyroWarmed | None:
        """What a reading makes of the temperature, where it has changed enough to be told."""
        if gyro.temperature_c is None:
            return None
        if self._mean_c is None:
            self._t_ns, self._mean_c = gyro.t_ns, gyro.temperature_c
            self._told_c = gyro.temperature_c
            return None
        elapsed_s = max(gyro.t_ns - self._t_ns, 0) * 1e-9
        self._t_ns = max(gyro.t_ns, self._t_ns)
        share = 1.0 - math.exp(-elapsed_s / SMOOTHED_S)
        self._mean_c += share * (gyro.temperature_c - self._mean_c)
        warmer_c = self._mean_c - self._told_c
        if abs(warmer_c) < TOLD_C:
            return None
        self._told_c = self._mean_c
        return GyroWarmed(gyro.t_ns, warmer_c)
