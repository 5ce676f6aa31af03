"""Pure: how far a vehicle went up, of which an altitude that wavers adds nothing."""

import math
from dataclasses import dataclass

LEAST_M = 3.0
"""Bridges and kerbs are no climbs."""
SIGMAS = 3.0
"""What an altitude goes up by less than this many of its stds may be its error."""
WINDOW_NS = 5_000_000_000
"""Altitudes of so long are looked at as their mean, in which what jitters from one to the next is
small; a road's height hardly bends in so short a time."""


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
    _since_ns: int | None = None
    _sum_m: float = 0.0
    _count: int = 0
    """Of the altitudes since then."""

    def take(self, t_ns: int, alt_m: float | None, std_m: float | None) -> None:
        """The next altitude, where it is known with its std."""
        if alt_m is None or std_m is None:
            return
        if self._since_ns is None:
            self._since_ns = t_ns
        self._sum_m += alt_m
        self._count += 1
        self._std_m = max(self._std_m, std_m)
        if self._low_m is None or t_ns - self._since_ns >= WINDOW_NS:
            self._turn(self._sum_m / self._count, max(LEAST_M, SIGMAS * std_m))
            self._since_ns, self._sum_m, self._count = t_ns, 0.0, 0

    @property
    def known(self) -> tuple[float | None, float | None]:
        """Metres up so far, and their std; None where no altitude was known."""
        if self._low_m is None:
            return None, None
        open_m = self._high_m - self._low_m if self._is_rising else 0.0
        ends = 2 * (self._turns + self._is_rising)
        return self.up_m + open_m, math.sqrt(max(ends, 1)) * self._std_m

    def _turn(self, alt_m: float, least_m: float) -> None:
        """A mean altitude; one that is off by less than `least_m` from an end may be error."""
        if self._low_m is None:
            self._low_m = self._high_m = alt_m
        elif not self._is_rising:
            if alt_m < self._low_m:
                self._low_m = alt_m
            elif alt_m - self._low_m >= least_m:
                self._high_m, self._is_rising = alt_m, True
        elif alt_m > self._high_m:
            self._high_m = alt_m
        elif self._high_m - alt_m >= least_m:
            self.up_m += self._high_m - self._low_m
            self._turns += 1
            self._low_m, self._is_rising = alt_m, False
