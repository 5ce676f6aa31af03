"""Pure: how far a vehicle went up, of which an altitude that wavers adds nothing."""

import math
from dataclasses import dataclass

LEAST_M = 3.0
"""Bridges and kerbs are no climbs."""
SIGMAS = 3.0
"""What an altitude goes up by less than this many of its stds may be its error."""


@dataclass(slots=True)
class Climb:
    """Adds up the ways from a low point to the next high one that are more than error."""

    up_m: float = 0.0
    _low_m: float | None = None
    _high_m: float = 0.0
    _is_rising: bool = False
    _turns: int = 0
    _std_m: float = 0.0
    """The largest of the altitudes'."""

    def take(self, alt_m: float | None, std_m: float | None) -> None:
        """The next altitude, where it is known with its std."""
        if alt_m is None or std_m is None:
            return
        self._std_m = max(self._std_m, std_m)
        if self._low_m is None:
            self._low_m = self._high_m = alt_m
        elif self._is_rising:
            self._rise(alt_m, max(LEAST_M, SIGMAS * std_m))
        else:
            self._fall(alt_m, max(LEAST_M, SIGMAS * std_m), self._low_m)

    @property
    def known(self) -> tuple[float | None, float | None]:
        """Metres up so far, and their std; None where no altitude was known."""
        if self._low_m is None:
            return None, None
        open_m = self._high_m - self._low_m if self._is_rising else 0.0
        ends = 2 * (self._turns + self._is_rising)
        return self.up_m + open_m, math.sqrt(max(ends, 1)) * self._std_m

    def _rise(self, alt_m: float, least_m: float) -> None:
        if alt_m > self._high_m:
            self._high_m = alt_m
        elif self._high_m - alt_m >= least_m and self._low_m is not None:
            self.up_m += self._high_m - self._low_m
            self._turns += 1
            self._low_m, self._is_rising = alt_m, False

    def _fall(self, alt_m: float, least_m: float, low_m: float) -> None:
        if alt_m < low_m:
            self._low_m = alt_m
        elif alt_m - low_m >= least_m:
            self._high_m, self._is_rising = alt_m, True
