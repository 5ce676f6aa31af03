"""Pure: how noisy the wheels' speed is."""

import math

from wayline.resolution import SPEED_UNIT_MPS, Resolution

READINGS = 100.0
"""Over which the noise is learned."""
COARSEST_STD_MPS = 0.08
"""Of steps of 1 km/h; until enough is read, steps seem larger."""
JERK_MPS = 0.15
"""Of a second difference at most: more is a driver's foot, not noise."""


class WheelNoise:
    """White noise and steps of the wheels' speed, by its second differences."""

    def __init__(self, held_s: float, slowest_mps: float) -> None:
        self._held_s, self._slowest_mps = held_s, slowest_mps
        self._steps = Resolution(SPEED_UNIT_MPS)
        self._variance = 0.0
        self._weight = 0.0
        self._before: tuple[int, float] | None = None
        self._change: tuple[float, float] | None = None
        """Of the speed, and in what time."""

    def std_mps(self, readings: int = 1) -> float:
        """One sigma of a mean of readings; steps are alike from one to the next and stay."""
        steps_mps = min(self._steps.std, COARSEST_STD_MPS)
        return max(math.sqrt(self._variance / readings), steps_mps)

    def learn(self, t_ns: int, speed_mps: float) -> None:
        """Take a reading into account."""
        self._steps.learn(speed_mps)
        before, self._before = self._before, (t_ns, speed_mps)
        if before is None or not 0.0 < (t_ns - before[0]) * 1e-9 <= self._held_s:
            self._change = None
            return
        earlier, self._change = self._change, (speed_mps - before[1], (t_ns - before[0]) * 1e-9)
        if earlier is None or speed_mps < self._slowest_mps:
            return
        second_mps = self._change[0] - earlier[0] * self._change[1] / earlier[1]
        self._weight = min(self._weight + 1.0, READINGS)
        sample = min(abs(second_mps), JERK_MPS) ** 2 / 6.0
        self._variance += (sample - self._variance) / self._weight
