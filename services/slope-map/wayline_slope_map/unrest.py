"""Pure: how bendy a road is, by the differences of the slopes that torque told along it.

Not by the likelihood of the run: the noise of every sensor would be mistaken for road, or the road
for noise. Torque tells slopes directly, so that over 100 m the road stands out of its noise.
"""

import math

import numpy as np

from wayline.line import Floats
from wayline.tuning import Tuning
from wayline_slope_map.slopes import Slopes, Window

CELL_M = 100.0
COVERED_SHARE = 0.6
"""Of a cell, by torque; less says little of its mean."""
FEWEST = 20
"""Pairs of neighbouring cells, two kilometres of road."""
MEAN_FACTOR = 1.2
"""Means over 100 m level the curves that are shorter."""
CALMEST_PCT_PER_M = 0.01
"""Of a motorway in the plain: 2 % of slope in 200 m."""
GRAVITY_MPS2 = 9.81


def curvature_std_pct_per_m(torque: Slopes, tuning: Tuning) -> float:
    """Std of a road's curvature; what is configured where too little was told, and at most that."""
    most = tuning.curvature_std_pct_per_m
    windows = [window for window in torque.windows if window is not None]
    if len(windows) < 2:
        return most
    means, variances = _cells(torque, windows, tuning.torque_std_pct / 100.0)
    changes = np.diff(means)
    noise = variances[1:] + variances[:-1]
    told = np.isfinite(changes)
    if np.count_nonzero(told) < FEWEST:
        return most
    square = max(float(np.mean(changes[told] ** 2 - noise[told])), 0.0)
    found = 100.0 * MEAN_FACTOR * math.sqrt(square) / CELL_M
    return min(max(found, CALMEST_PCT_PER_M), most)


def _cells(torque: Slopes, windows: list[Window], white: float) -> tuple[Floats, Floats]:
    """Mean slope of every 100 m and its variance by noise; NaN where little was told."""
    lengths_s = np.array([window.length_s for window in windows])
    slopes = torque.share - np.array([window.level for window in windows])
    speeds_mps = np.gradient(torque.travelled_m, torque.times_s)
    cells = (torque.travelled_m / CELL_M).astype(np.intp)
    cells -= cells.min()
    seconds = np.bincount(cells, lengths_s)
    covered_m = np.bincount(cells, lengths_s * speeds_mps)
    enough = covered_m >= COVERED_SHARE * CELL_M
    seconds[~enough] = np.nan
    means = np.bincount(cells, lengths_s * slopes) / seconds
    speed_std_mps = max(window.speed_std_mps for window in windows)
    ends = 2.0 * (speed_std_mps / (GRAVITY_MPS2 * seconds)) ** 2
    return means, white**2 / seconds + ends
