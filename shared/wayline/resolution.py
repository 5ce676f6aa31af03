"""Pure: how coarse a sensor's steps are, learned from its readings."""

import math

PRESSURE_UNIT_PA = 0.1
"""Of barometers."""
SPEED_UNIT_MPS = 1.0 / 3600.0
"""Of wheels: buses tell km/h and hundredths of them, or hundredths of m/s; both are whole so."""
FINEST = 1
"""A step of one unit stays one, whatever is read."""


class Resolution:
    """The step of a quantised sensor: the greatest common divisor of all its readings so far.

    Conservative at first (few readings share large divisors), exact soon.
    """

    def __init__(self, unit: float) -> None:
        self._unit = unit
        self._divisor = 0
        self.settled = False
        """Whether no reading can tell of finer steps."""
        self.std = 0.0
        """Standard deviation of rounding to the step: step / sqrt(12)."""

    def learn(self, value: float) -> bool:
        """Take a reading into account; whether it tells of other steps than those before."""
        divisor = math.gcd(self._divisor, round(value / self._unit))
        if divisor == self._divisor:
            return False
        self._divisor, self.settled = divisor, divisor == FINEST
        self.std = self._divisor * self._unit / math.sqrt(12.0)
        return True
