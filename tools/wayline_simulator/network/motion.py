"""Pure: how a bus moves along a way: from standstill to standstill, evenly up and down."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

RATE_MPS2 = 1.0
"""Of a bus with standing passengers."""


class Motion(NamedTuple):
    """Knots between which acceleration is constant; shape (n,) each."""

    times_s: Floats
    alongs_m: Floats
    speeds_mps: Floats

    def at(self, times_s: Floats) -> tuple[Floats, Floats]:
        """Distance along and speed at instants; it stands before the first knot and the last."""
        clipped = np.clip(times_s, self.times_s[0], self.times_s[-1])
        knot = np.searchsorted(self.times_s, clipped, side="right") - 1
        knot = np.minimum(knot, len(self.times_s) - 1)
        speeds_mps = np.interp(clipped, self.times_s, self.speeds_mps)
        since_s = clipped - self.times_s[knot]
        gone_m = (self.speeds_mps[knot] + speeds_mps) / 2.0 * since_s
        return self.alongs_m[knot] + gone_m, speeds_mps

    def passes_s(self, along_m: float) -> float:
        """When a place is first reached."""
        knot = max(int(np.searchsorted(self.alongs_m, along_m)), 1)
        before_m, speed_mps = self.alongs_m[knot - 1], self.speeds_mps[knot - 1]
        took_s = max(self.times_s[knot] - self.times_s[knot - 1], 1e-9)
        rate_mps2 = (self.speeds_mps[knot] - speed_mps) / took_s
        left_m = along_m - before_m
        if left_m <= 0.0:
            return float(self.times_s[knot - 1])
        # left = v t + a t^2 / 2
        root_mps = math.sqrt(max(speed_mps**2 + 2.0 * rate_mps2 * left_m, 0.0))
        return float(self.times_s[knot - 1] + 2.0 * left_m / (speed_mps + root_mps))


class Driving:
    """Gathers the knots of a motion that begins with a stand."""

    def __init__(self, time_s: float, along_m: float = 0.0) -> None:
        self._knots = [(time_s, along_m, 0.0)]

    @property
    def time_s(self) -> float:
        """Of the last knot."""
        return self._knots[-1][0]

    def stand_until(self, time_s: float) -> None:
        """Not to go on before an instant; one that has passed changes nothing."""
        if time_s > self.time_s:
            self._knots.append((time_s, self._knots[-1][1], 0.0))

    def go(self, to_m: float, speed_mps: float) -> None:
        """On to the next standstill, at that speed where the way is long enough."""
        time_s, along_m, _ = self._knots[-1]
        way_m = to_m - along_m
        top_mps = min(speed_mps, math.sqrt(way_m * RATE_MPS2))
        changing_s, changing_m = top_mps / RATE_MPS2, top_mps**2 / (2.0 * RATE_MPS2)
        even_s = (way_m - 2.0 * changing_m) / top_mps
        self._knots += [
            (time_s + changing_s, along_m + changing_m, top_mps),
            (time_s + changing_s + even_s, to_m - changing_m, top_mps),
            (time_s + 2.0 * changing_s + even_s, to_m, 0.0),
        ]

    def motion(self) -> Motion:
        """All of it."""
        times_s, alongs_m, speeds_mps = np.array(self._knots).T
        return Motion(times_s, alongs_m, speeds_mps)


def takes_s(way_m: float, speed_mps: float) -> float:
    """How long it takes from one standstill to the next."""
    driving = Driving(0.0)
    driving.go(way_m, speed_mps)
    return driving.time_s
