"""Pure: how a simulated drive's wheels really wandered, slip and tyres included."""

import math
from typing import NamedTuple

import numpy as np

from wayline_evaluation.motion import integral
from wayline_evaluation.reference import Reference
from wayline_evaluation.sensed import Sensed

WINDOW_S = 2.0
"""Mean over so long takes out the sensor's own noise and rounding."""
APART_S = 10.0
"""At this lag the correlation is taken that gives the time constant."""
SHORTEST_S, LONGEST_S = 2.0, 3600.0
MOVING_MPS = 3.0
"""Slower, rounding says more than slip."""


class Wander(NamedTuple):
    """Of a first-order Gauss-Markov process."""

    std: float
    time_s: float


def wheel_wander(sensed: Sensed, truth: Reference) -> Wander | None:
    """Of true over measured distance, about its mean; None where too little was driven."""
    edges_s = np.arange(truth.times_s[0], truth.times_s[-1], WINDOW_S)
    true_m = np.diff(np.interp(edges_s, truth.times_s, truth.distances_m))
    wheels_m = np.abs(np.diff(integral(sensed.speed_mps, edges_s)))
    moving = np.minimum(true_m, wheels_m) > MOVING_MPS * WINDOW_S
    if np.count_nonzero(moving) < 10:
        return None
    scales = np.where(moving, true_m / np.where(moving, wheels_m, 1.0), np.nan)
    off = scales - np.nanmean(scales)
    variance = float(np.nanmean(np.square(off)))
    lag = round(APART_S / WINDOW_S)
    together = off[lag:] * off[:-lag]
    if variance == 0.0 or np.isnan(together).all():
        return None
    correlation = float(np.clip(np.nanmean(together) / variance, 1e-3, 0.999))
    time_s = float(np.clip(-APART_S / math.log(correlation), SHORTEST_S, LONGEST_S))
    return Wander(math.sqrt(variance), time_s)
