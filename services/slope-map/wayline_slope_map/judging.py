"""Pure: what the kept runs of a road say of each other: which are outliers, what they share.

Judged whenever a road is read, from all its runs in order of time, so that the order in which they
were merged changes nothing.
"""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wayline.line import Floats

OUTLIER_STDS = 4.0
"""A grade so many of its stds from the median of three runs or more is none of this road."""
DOUBTED_STDS = 1.0
"""Beside an outlier, within NEAR_M, a grade so far off is of the same fault."""
NEAR_M = 300.0
FEWEST_RUNS = 3
COMMON_SHARE = 0.5
"""Share of a run's grade variance that every run over the same road has in common, before it is
estimated: at a smoother's optimum noise and lag behind the slope give the same variance."""
COMMON_BOUNDS = (0.1, 0.9)
PRIOR_RUNS = 1.0
"""What that is worth, in further runs."""
STD_FLOOR_PCT = 0.05


class Grades(NamedTuple):
    """Of one run by all its sensors: bin to grade and std, in percent."""

    by_bin: Mapping[int, tuple[float, float]]


class Judgement(NamedTuple):
    """Of a road's runs in one direction."""

    flagged: tuple[frozenset[int], ...]
    """Of each run the bins in which it is an outlier."""
    common_share: float
    """Share of the variance that the runs have in common."""


def judged(runs: Sequence[Grades], bin_m: float) -> Judgement:
    """Hold runs against each other; they come in an order that is theirs."""
    indices = sorted({index for run in runs for index in run.by_bin})
    if not indices:
        return Judgement(tuple(frozenset() for _ in runs), COMMON_SHARE)
    first = indices[0]
    grades = np.full((len(runs), indices[-1] - first + 1), np.nan)
    stds = np.full_like(grades, np.nan)
    for row, run in enumerate(runs):
        places = np.array(list(run.by_bin), dtype=np.intp) - first
        grades[row, places], stds[row, places] = np.array(list(run.by_bin.values())).T
    outliers = _outliers(grades, np.maximum(stds, STD_FLOOR_PCT), round(NEAR_M / bin_m))
    flagged = tuple(frozenset((np.flatnonzero(row) + first).tolist()) for row in outliers)
    return Judgement(flagged, _common_share(np.where(outliers, np.nan, grades), stds))


def _outliers(grades: Floats, stds: Floats, near: int) -> NDArray[np.bool_]:
    """Shape (runs, bins); never half of a bin's runs or more."""
    counts = np.isfinite(grades).sum(axis=0)
    median = np.zeros(grades.shape[1])
    enough = counts >= FEWEST_RUNS
    median[enough] = np.nanmedian(grades[:, enough], axis=0)
    off = np.nan_to_num(np.abs(grades - median) / stds)
    off[:, ~enough] = 0.0
    beside = np.array([_widened(row > OUTLIER_STDS, near) for row in off])
    outliers = beside & (off > DOUBTED_STDS)
    outliers[:, 2 * outliers.sum(axis=0) >= counts] = False
    return outliers


def _widened(row: NDArray[np.bool_], near: int) -> NDArray[np.bool_]:
    """True wherever a true one is near."""
    window = np.ones(2 * near + 1)
    return np.convolve(row, window, mode="full")[near : near + len(row)] > 0.5


def _common_share(grades: Floats, stds: Floats) -> float:
    """By how much runs differ less than they claim to err, over all bins of two runs and more."""
    counts = np.isfinite(grades).sum(axis=0)
    several = counts > 1
    if not several.any():
        return COMMON_SHARE
    differ = np.nanvar(grades[:, several], axis=0, ddof=1)
    claimed = np.nanmean(np.where(np.isfinite(grades), stds, np.nan)[:, several] ** 2, axis=0)
    own_share = float(np.sum(differ) / np.sum(claimed))
    further = float(np.mean(counts[several])) - 1.0
    found = (further * (1.0 - own_share) + PRIOR_RUNS * COMMON_SHARE) / (further + PRIOR_RUNS)
    return min(max(found, COMMON_BOUNDS[0]), COMMON_BOUNDS[1])
