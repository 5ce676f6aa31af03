"""Pure: the angle that the gyro has measured, between any two instants of the last seconds."""

from bisect import bisect_left
from collections.abc import Callable

LONGEST_HOLD_NS = 1_000_000_000
"""A rate is held this long when samples stop (SPEC section 2)."""
KEPT_NS = 4_000_000_000
TRIM_AT = 2_000
RECENT = 32
"""Samples; nearly all questions are of an instant among them."""

TakeGyro = Callable[[int, float], None]
"""Takes an instant and a rate in rad/s, clockwise."""


class GyroTrack:
    """Integrates measured yaw rate (rad/s, clockwise, uncorrected) by the trapezoidal rule."""

    def __init__(self) -> None:
        self._times_ns: list[int] = []
        self._angles_rad: list[float] = []
        self._rates_radps: list[float] = []

    def add(self, t_ns: int, rate_radps: float) -> None:
        """Append a sample; one that does not advance time is ignored."""
        times_ns = self._times_ns
        angle_rad = 0.0
        if times_ns:
            gap_ns, last_rate = t_ns - times_ns[-1], self._rates_radps[-1]
            if gap_ns <= 0:
                return
            if gap_ns <= LONGEST_HOLD_NS:
                turned = 0.5 * (last_rate + rate_radps) * gap_ns * 1e-9
            else:
                turned = last_rate * LONGEST_HOLD_NS * 1e-9
            angle_rad = self._angles_rad[-1] + turned
        times_ns.append(t_ns)
        self._angles_rad.append(angle_rad)
        self._rates_radps.append(rate_radps)
        if len(times_ns) > TRIM_AT:
            self._trim(t_ns - KEPT_NS)

    def turned_rad(self, from_ns: int, to_ns: int) -> float | None:
        """Measured turn between two instants; None where the gyro was silent at the end."""
        place = self._covered(to_ns)
        if place is None:
            return None
        return self._angle(to_ns, place) - self._angle(from_ns, self._place(from_ns))

    def angle_rad(self, t_ns: int) -> float | None:
        """Measured turn since the gyro began; None where it was silent."""
        place = self._covered(t_ns)
        return None if place is None else self._angle(t_ns, place)

    def covers(self, t_ns: int) -> bool:
        """Whether a sample no older than the longest hold tells the rate at an instant."""
        return self._covered(t_ns) is not None

    def rate_radps(self, t_ns: int) -> float | None:
        """Measured rate at or just before an instant; None where the gyro was silent."""
        place = self._covered(t_ns)
        if place is None:
            return None
        if place < len(self._times_ns) and self._times_ns[place] == t_ns:
            return self._rates_radps[place]
        return self._rates_radps[max(place - 1, 0)]

    def _place(self, t_ns: int) -> int:
        """Of the first sample that is not before an instant."""
        times = self._times_ns
        recent = len(times) - RECENT
        return bisect_left(times, t_ns, recent if recent > 0 and times[recent] < t_ns else 0)

    def _covered(self, t_ns: int) -> int | None:
        """Its place, where the sample before it is not too old to tell the rate."""
        times, place = self._times_ns, self._place(t_ns)
        if place == 0:
            return 0 if times else None
        return place if t_ns - times[place - 1] <= LONGEST_HOLD_NS else None

    def _angle(self, t_ns: int, place: int) -> float:
        times = self._times_ns
        if place == 0:
            return self._angles_rad[0] + self._rates_radps[0] * (t_ns - times[0]) * 1e-9
        if place == len(times):
            held_ns = min(t_ns - times[-1], LONGEST_HOLD_NS)
            return self._angles_rad[-1] + self._rates_radps[-1] * held_ns * 1e-9
        share = (t_ns - times[place - 1]) / (times[place] - times[place - 1])
        before = self._angles_rad[place - 1]
        return before + share * (self._angles_rad[place] - before)

    def _trim(self, oldest_ns: int) -> None:
        place = bisect_left(self._times_ns, oldest_ns)
        del self._times_ns[:place], self._angles_rad[:place], self._rates_radps[:place]
