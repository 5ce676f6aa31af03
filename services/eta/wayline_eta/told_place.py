"""Pure: what has been told of a vehicle's place, and how that is taken back where it was too much.

A vehicle that nobody saw may have stood. What was told too much of it is taken back in steps of
noise, one each second: to wait until the vehicle has caught up would cost 20 m at the 95th
percentile.
"""

import math

HOLD_M = 30.0
"""A place that falls back by less than this is noise: progress waits for it to catch up."""
TAKEN_BACK_MPS = 30.0
WENT_BACK_M = 100.0
"""A vehicle that is so far behind where it was seen last is on another place than was told."""


class ToldPlace:
    """Of one vehicle on one route, in metres along it over all laps."""

    def __init__(self) -> None:
        self._told_m = self._waits_at_m = -math.inf
        """What had been told at an instant, and down to where that is taken back."""
        self._t_ns = 0

    def floor_m(self, t_ns: int) -> float:
        """What had been told, as far as it is not taken back yet."""
        since_s = (t_ns - self._t_ns) * 1e-9
        return max(self._told_m - TAKEN_BACK_MPS * (since_s + 1.0), self._waits_at_m)

    def keep(self, t_ns: int) -> None:
        """A report has come: what is left now is taken back from now on."""
        self._told_m, self._t_ns = self.floor_m(t_ns), t_ns

    def report(
        self, expected_m: float | None, last_m: float, now_m: float, *, drives: bool
    ) -> None:
        """Wait for a vehicle that reports from behind what was told of it, after `keep`.

        It was expected there, if anywhere, and seen at `last_m` before. Where it stands it is told
        to stand.
        """
        told_m = now_m
        if expected_m is not None and now_m >= last_m - WENT_BACK_M:
            told_m = max(expected_m, now_m, self._told_m)
        self._told_m = told_m
        self._waits_at_m = min(told_m, now_m + (HOLD_M if drives else 0.0))

    def see(self, t_ns: int, told_m: float, last_m: float, now_m: float) -> None:
        """A vehicle of whose reports so much was told is seen all the time from now on."""
        went_back = now_m < last_m - WENT_BACK_M
        self._told_m, self._waits_at_m = -math.inf if went_back else told_m, -math.inf
        self._t_ns = t_ns
