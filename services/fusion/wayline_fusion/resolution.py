"""Pure: how coarse a sensor's steps are, learned from its readings."""

import math

FINEST = 1
"""A step of one unit stays one, whatever is read."""


class Resolution:
    """The step of a quantised sensor: the greatest common divisor of all its readings so far.

    Conservative at first (few readings share large divisors), exact soon.
    """

    def __init__(self, unit: float) -> None:
        self._unit = unit
        self._divisor = 0
        self.std = 0.0
        """Standard deviation of rounding to the step: step / sqrt(12)."""

    def learn(self, value: float) -> bool:
        """Take a reading into account; whether it tells of other steps than those before."""
        before = self._divisor
        if before == FINEST:
            return False
        self._divisor = math.gcd(before, round(value / self._unit))
        if self._divisor == before:
            return False
        self.std = self._divisor * self._unit / math.sqrt(12.0)
        return True
