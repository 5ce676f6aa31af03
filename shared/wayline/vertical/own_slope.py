"""Pure: the slope that a vehicle itself reports (papers/004 section 3.3), as means of a second."""

from typing import NamedTuple

from wayline.messages import Torque
from wayline.vertical.driveline import Driveline

MEAN_NS = 1_000_000_000
MOST_PCT = 40.0
"""No vehicle measures a steeper road."""


class OwnSlope(NamedTuple):
    """The mean of the reports of about a second."""

    t_ns: int
    """Of the last."""
    length_s: float
    slope: float
    """tan of the slope angle."""

    @property
    def middle_ns(self) -> int:
        """The instant that the mean is of."""
        return self.t_ns - round(0.5e9 * self.length_s)


class OwnSlopes:
    """Takes one vehicle's torque messages in order of time."""

    def __init__(self, driveline: Driveline) -> None:
        self._driveline = driveline
        self._since_ns: int | None = None
        self._sum = 0.0
        self._count = 0

    def take(self, torque: Torque) -> OwnSlope | None:
        """The mean that a message completes; reports at brake, clutch or shifts begin it anew."""
        slope_pct, t_ns = torque.slope_pct, torque.t_ns
        if not self._driveline.is_settled(t_ns) or abs(slope_pct or 0.0) > MOST_PCT:
            self._since_ns = None
            return None
        if slope_pct is None:
            return None
        if self._since_ns is None or t_ns - self._since_ns > 2 * MEAN_NS:
            self._since_ns, self._sum, self._count = t_ns, 0.0, 0
        self._sum += slope_pct / 100.0
        self._count += 1
        if t_ns - self._since_ns < MEAN_NS:
            return None
        mean = OwnSlope(t_ns, (t_ns - self._since_ns) * 1e-9, self._sum / self._count)
        self._since_ns = None
        return mean
