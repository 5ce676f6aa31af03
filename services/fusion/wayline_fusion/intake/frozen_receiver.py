"""Pure: a receiver that tells one position again and again, each time with a new time."""

from wayline.messages import GpsFix

LEFT_M = 20.0
"""Driven since a position was told first; coarse receivers tell one of 4 decimals for 11 m."""
LONGEST_NS = 2_000_000_000
"""Between two fixes; over a longer silence nothing is known of the way."""


class FrozenReceiver:
    """Compares one receiver's fixes with the distance that the vehicle has driven meanwhile."""

    def __init__(self) -> None:
        self._last: GpsFix | None = None
        self._wheels_m: float | None = None
        self._left_m = 0.0

    def is_frozen(self, fix: GpsFix, wheels_m: float | None) -> bool:
        """Whether a valid fix repeats a position that the vehicle has left.

        `wheels_m` is the distance by its wheels so far; without wheels the fixes' own speed
        tells how far it went.
        """
        last, self._last = self._last, fix
        before_m, self._wheels_m = self._wheels_m, wheels_m
        is_same = last is not None and (fix.lat_deg, fix.lon_deg) == (last.lat_deg, last.lon_deg)
        if last is None or not is_same:
            self._left_m = 0.0
        elif wheels_m is not None and before_m is not None:
            self._left_m += wheels_m - before_m
        elif 0 < fix.t_ns - last.t_ns <= LONGEST_NS and not fix.speed_derived:
            self._left_m += (fix.speed_mps or 0.0) * (fix.t_ns - last.t_ns) * 1e-9
        return self._left_m > LEFT_M
