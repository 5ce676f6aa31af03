"""Pure: the Rauch-Tung-Striebel smoother of a value whose rate of change walks at random.

State (value, rate), F = [[1, dt], [0, 1]], H = [1, 0],
Q = density**2 [[dt**3 / 3, dt**2 / 2], [dt**2 / 2, dt]]. Of a linear model the smoothed states are
those of the least squares over all steps and measurements (Rauch, Tung and Striebel 1965), whose
normal equations have three diagonals beside the main one. scipy's banded Cholesky solves them in a
microsecond a step, where a filter and a smoother step by step take a hundred; a test holds both
equal.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cho_solve_banded, cholesky_banded

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]

RATE_STD = 1e3
"""Before anything is measured, of the rate, and of a value that is never measured: unknown."""
STATES = 2
BANDS = 3
STEP_MIN_S = 1e-3
ROBUST_STDS = 3.0
"""A measurement so many stds from the others counts by half."""
ROUNDS = 6
"""Of weighing measurements anew; what lies far off is without weight after three."""


class Smoothed(NamedTuple):
    """What the smoother makes of measurements at n instants."""

    values: Floats
    """Shape (n,) or (n, axes), as measured."""
    rates: Floats
    """A second, shape of the values."""
    weights: Floats
    """Shape (n,): 1 where a measurement fits the others, near 0 where it does not."""
    std_of_sum: Callable[[Floats], float]
    """One sigma of the sum of the values, each times a factor; shape (n,)."""


def smoothed(times_s: Floats, measured: Floats, stds: Floats, density: float) -> Smoothed:
    """States at instants that increase, by measurements, nan where there is none.

    `measured` is (n,) or (n, axes), `stds` (n,) is one sigma of each axis, `density` the std that
    a second adds to the rate. What fits neither its neighbours nor the model loses its weight.
    """
    known = ~np.isnan(_lengths(measured))
    information = np.where(known, 1.0 / np.square(stds), 0.0)
    targets = np.where(np.isnan(measured), 0.0, measured)
    model = _model(times_s, density)
    weights = np.ones(len(times_s))
    for _ in range(ROUNDS):
        factor, states = _solved(model, information * weights, targets)
        off = _lengths(targets - states[::STATES]) / stds
        weights = 1.0 / (1.0 + np.square(off / ROBUST_STDS))
    return Smoothed(
        values=states[::STATES],
        rates=states[1::STATES],
        weights=np.where(known, weights, 0.0),
        std_of_sum=lambda factors: _std_of_sum(factor, factors),
    )


def _lengths(rows: Floats) -> Floats:
    lengths: Floats = np.abs(rows) if rows.ndim == 1 else np.linalg.norm(rows, axis=1)
    return lengths


def _model(times_s: Floats, density: float) -> Floats:
    """Upper diagonals of the normal equations of the steps alone, the main one last."""
    dt = np.maximum(np.diff(times_s), STEP_MIN_S)
    cubed, squared, plain = (
        factor / (density**2 * dt**power) for factor, power in ((12.0, 3), (6.0, 2), (2.0, 1))
    )
    bands = np.zeros((BANDS + 1, STATES * len(times_s)))
    here, there = bands[:, :-STATES], bands[:, STATES:]
    # F' Q^-1 F at a step's beginning, Q^-1 at its end, -F' Q^-1 between
    here[3, ::2] += cubed
    here[3, 1::2] += 2.0 * plain
    here[2, 1::2] += squared
    there[3, ::2] += cubed
    there[3, 1::2] += 2.0 * plain
    there[2, 1::2] -= squared
    there[1, ::2] -= cubed
    there[2, ::2] -= squared
    there[0, 1::2] += squared
    there[1, 1::2] += plain
    bands[3, :STATES] += 1.0 / RATE_STD**2
    return bands


def _solved(model: Floats, information: Floats, targets: Floats) -> tuple[Floats, Floats]:
    bands = model.copy()
    bands[3, ::STATES] += information
    right = np.zeros((bands.shape[1], *targets.shape[1:]))
    right[::STATES] = (targets.T * information).T
    factor = cholesky_banded(bands)
    return factor, cho_solve_banded((factor, False), right)


def _std_of_sum(factor: Floats, factors: Floats) -> float:
    right = np.zeros(STATES * len(factors))
    right[::STATES] = factors
    return float(np.sqrt(right @ cho_solve_banded((factor, False), right)))
