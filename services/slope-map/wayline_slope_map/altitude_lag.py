"""Pure: by how long a receiver's altitudes come late, as the other sensors tell.

Receivers filter altitudes harder than positions: papers/004 moved its curves back by 12 s (section
5.2.3). The run by barometer and torque alone is where the vehicle was; the lag is the one at which
a receiver's climbs are the most likely beside it.
"""

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from wayline.line import Floats

LONGEST_S = 15.0
STEP_S = 0.5
CLIMB_S = 10.0
"""Climbs over so long are compared: hills differ, and a slow error has hardly changed."""
UNEVEN_S = 1.0
"""Altitudes so far from CLIMB_S apart are no pair."""
OUTLIER_STDS = 3.0
"""A climb that differs by more counts as one that differs by so much."""
SURE = 2.0
"""The logarithm of the likelihood grows by as much for an error of two stds: less is no lag."""

Indices = NDArray[np.intp]
Heights = Callable[[Floats], Floats]
"""Altitude in m at instants in s."""


def lag_s(times_s: Floats, alt_m: Floats, truth: Heights) -> float:
    """How long a receiver's altitudes, shape (n,) in order of time, come after the vehicle's.

    0 where no lag is surely more likely.
    """
    begins, ends = _pairs(times_s)
    if len(begins) < 2:
        return 0.0
    lags_s = np.arange(0.0, LONGEST_S + STEP_S, STEP_S)
    squares = np.array(
        [_square(alt_m - truth(times_s - lag), begins, ends) for lag in lags_s.tolist()]
    )
    best = int(np.argmin(squares))
    # climbs that overlap tell the same
    independent = len(begins) * float(np.median(np.diff(times_s))) / CLIMB_S
    if best == len(lags_s) - 1 or not _is_sure(squares[0], squares[best], independent):
        return 0.0
    return float(lags_s[best]) + STEP_S * _vertex(*squares[best - 1 : best + 2].tolist())


def _pairs(times_s: Floats) -> tuple[Indices, Indices]:
    """Indices of altitudes CLIMB_S apart."""
    ends = np.minimum(np.searchsorted(times_s, times_s + CLIMB_S), len(times_s) - 1)
    even = np.abs(times_s[ends] - times_s - CLIMB_S) <= UNEVEN_S
    return np.flatnonzero(even), ends[even]


def _square(error_m: Floats, begins: Indices, ends: Indices) -> float:
    """Mean square by which climbs differ."""
    differ_m = np.abs(error_m[ends] - error_m[begins])
    most_m = OUTLIER_STDS * 1.5 * float(np.median(differ_m))
    return float(np.mean(np.minimum(differ_m, most_m) ** 2))


def _is_sure(square: float, least: float, independent: float) -> bool:
    if least <= 0.0:
        return square > 0.0
    return 0.5 * independent * math.log(square / least) > SURE


def _vertex(before: float, least: float, after: float) -> float:
    """Where a parabola through three values a step apart is lowest, from the middle one."""
    bend = before - 2.0 * least + after
    return 0.5 * (before - after) / bend if bend > 0.0 else 0.0
