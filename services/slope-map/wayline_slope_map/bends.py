"""Pure: how bendy a road is, cell by cell, and how far torque is biased, as a smoothed run tells.

Roads are even slopes joined by vertical curves: a curvature with one std all along cuts the crests
and lets noise through between them. Each pass over a run tells the curvature's mean square in every
cell, what it does not know included; that is the next pass's std there (expectation maximisation,
with the road's usual bends as prior). Where little is measured the std hardly changes.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wayline.line import Floats
from wayline.tuning import Tuning
from wayline.vertical.states import VerticalStates

S = VerticalStates
CELL_M = 40.0
"""Half of a short vertical curve."""
BESIDE = 1
"""Cells before and behind that count as well: curvature is known no better."""
USUAL_WEIGHT = 0.3
"""What the road's usual square, the geometric mean of all cells, is worth beside a cell's own."""
FEWEST_SLOPES = 200
"""Altitudes alone tell single bends too badly: each pass would take more of the hills for noise."""
BENDY_FACTOR = 2.5
"""On the curvature's std that is configured, where torque and barometer do not tell of bends both:
crests that are cut stay cut in the map, noise averages out over the runs, and beside GPS alone a
mass is soon whatever makes slopes calm. Altimeters alone begin with it."""
CALM_FACTOR = 1.0
"""The least on that std."""
MISSED_FACTOR = 1.1
"""On what altimeters alone tell of bends: they take some of them for noise."""
LEAST_TOLD_SHARE = 0.1
"""Of torque's bias: less is no ground to tell its size by."""
BIAS_FACTORS = (0.3, 3.0)
"""On the std of torque's bias that is configured; one run does not tell of less, nor of more."""


class Learned(NamedTuple):
    """What a pass over a run starts from."""

    curvature_std: Floats
    """Tangent of the slope for a metre, at each node, shape (n,)."""
    torque_bias_std_pct: float


def first(count: int, tuning: Tuning, *, is_told: bool) -> Learned:
    """Before the first pass over so many nodes, and whether torque and barometer tell of bends."""
    factor = 1.0 if is_told else BENDY_FACTOR
    curvature_std = factor * tuning.curvature_std_pct_per_m / 100.0
    return Learned(np.full(count, curvature_std), tuning.torque_bias_std_pct)


def learned(travelled_m: Floats, x: Floats, P: Floats, tuning: Tuning, before: Learned) -> Learned:
    """After a pass from `before` that left these states, shapes (n, size) and (n, size, size)."""
    told = x[:, S.CURVATURE] ** 2 + P[:, S.CURVATURE, S.CURVATURE]
    cells = ((travelled_m - travelled_m[0]) / CELL_M).astype(np.intp)
    means = _cell_means(cells, told)
    usual = math.exp(float(np.mean(np.log(means))))
    squares = (USUAL_WEIGHT * usual + means) / (USUAL_WEIGHT + 1.0)
    return Learned(np.sqrt(squares)[cells], _bias_std_pct(x, P, tuning, before))


def _bias_std_pct(x: Floats, P: Floats, tuning: Tuning, before: Learned) -> float:
    """How far torque is biased: what was found of it, over the share of it that a run can find.

    MacKay's rule (1992), which is nearer after two passes than expectation maximisation.
    """
    found = float(np.mean(x[:, S.TORQUE_BIAS] ** 2))
    unfound = float(np.mean(P[:, S.TORQUE_BIAS, S.TORQUE_BIAS]))
    told_share = max(1.0 - unfound / (before.torque_bias_std_pct / 100.0) ** 2, LEAST_TOLD_SHARE)
    least, most = (factor * tuning.torque_bias_std_pct for factor in BIAS_FACTORS)
    return min(max(100.0 * math.sqrt(found / told_share), least), most)


def calmed(travelled_m: Floats, x: Floats, P: Floats, tuning: Tuning, before: Learned) -> Learned:
    """As `learned`, from altitudes alone: they tell how bendy the road is as a whole."""
    told = x[:, S.CURVATURE] ** 2 + P[:, S.CURVATURE, S.CURVATURE]
    steps_m = np.maximum(np.diff(travelled_m, prepend=travelled_m[0]), 0.0)
    configured = tuning.curvature_std_pct_per_m / 100.0
    found = math.sqrt(float(np.sum(told * steps_m)) / max(float(np.sum(steps_m)), 1e-9))
    std = min(max(MISSED_FACTOR * found, CALM_FACTOR * configured), BENDY_FACTOR * configured)
    return Learned(np.full(len(travelled_m), std), before.torque_bias_std_pct)


def _cell_means(cells: NDArray[np.intp], values: Floats) -> Floats:
    """Means over cells and those beside them; cells without a node lie between their neighbours."""
    counts = np.bincount(cells)
    filled = np.flatnonzero(counts)
    sums = np.bincount(cells, values)
    means = np.interp(np.arange(len(counts)), filled, sums[filled] / counts[filled])
    window = np.full(2 * BESIDE + 1, 1.0 / (2 * BESIDE + 1))
    return np.convolve(np.pad(means, BESIDE, mode="edge"), window, mode="valid")
