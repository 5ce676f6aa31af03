"""Pure: what a simulated receiver's errors are scaled with."""

import math

from wayline_simulator.gps import DILUTION_TIME_S

ROUNDING = 0.1 / math.sqrt(12.0)
"""Std of a dilution in a sentence: some receivers tell it to a tenth."""


class Dilution:
    """Follows the reported dilution as slowly as the simulated receiver's own filter does.

    Without the lag a new set of satellites would seem to tell the wandering error: it scales it at
    once, while the fix does not move.
    """

    def __init__(self) -> None:
        self._value: float | None = None
        self._time_s = 0.0

    def at(self, reported: float, time_s: float) -> float:
        """The dilution that acts at a fix; fixes in order of time."""
        if self._value is None:
            self._value = reported
        followed = -math.expm1(-(time_s - self._time_s) / DILUTION_TIME_S)
        self._value += followed * (reported - self._value)
        self._time_s = time_s
        return self._value
