"""Pure: how alike two profiles of a road are, and how much later the hills of one come."""

import numpy as np

from wayline_evaluation.estimates import Floats

FARTHEST_M = 300.0
STEP_M = 5.0
FEWEST_POINTS = 10
"""Fewer points tell neither."""


def correlation_of(grades_pct: Floats, true_pct: Floats) -> float | None:
    """Pearson's, of profiles at the same points; None where too few are known or one is even."""
    known = np.isfinite(grades_pct) & np.isfinite(true_pct)
    if np.count_nonzero(known) < FEWEST_POINTS:
        return None
    grades, true = grades_pct[known], true_pct[known]
    stds = float(np.std(grades)) * float(np.std(true))
    if stds == 0.0:
        return None
    return float(np.mean((grades - grades.mean()) * (true - true.mean()))) / stds


def hills_shift_m(distances_m: Floats, grades_pct: Floats, true_pct: Floats) -> float | None:
    """How much farther along the road hills come than they are: positive is late.

    The shift at which the two profiles are most alike, found to a part of STEP_M by a parabola.
    `distances_m` increases, shape (n,) each. None where no shift within FARTHEST_M is best.
    """
    known = np.isfinite(grades_pct)
    if np.count_nonzero(known) < FEWEST_POINTS:
        return None
    shifts_m = np.arange(-FARTHEST_M, FARTHEST_M + STEP_M, STEP_M)
    alike = np.array(
        [
            _alike(distances_m + shift_m, distances_m[known], grades_pct[known], true_pct)
            for shift_m in shifts_m.tolist()
        ]
    )
    if not np.isfinite(alike).any():
        return None
    best = int(np.nanargmax(alike))
    if not 0 < best < len(alike) - 1:
        return None
    before, most, after = alike[best - 1 : best + 2].tolist()
    bend = before - 2.0 * most + after
    vertex = 0.5 * (before - after) / bend if bend < 0.0 else 0.0
    return float(shifts_m[best]) + STEP_M * vertex


def _alike(at_m: Floats, known_m: Floats, grades_pct: Floats, true_pct: Floats) -> float:
    moved_pct = np.interp(at_m, known_m, grades_pct, left=np.nan, right=np.nan)
    found = correlation_of(moved_pct, true_pct)
    return np.nan if found is None else found
