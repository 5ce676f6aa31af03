"""Pure: numbers in place of chance, from a fixed table: a replay is the same to the last bit."""

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtri

Floats = NDArray[np.float64]
Indices = NDArray[np.intp]

POINTS = 320
"""Numbers at a time."""
ROWS = 61


def _even_rows() -> Floats:
    """Numbers between 0 and 1, in each row evenly spread and in an order of its own."""
    order = np.random.default_rng(ROWS)
    return np.array([(order.permutation(POINTS) + 0.5) / POINTS for _ in range(ROWS)])


EVEN = _even_rows()
NORMAL: Floats = ndtri(EVEN)


class Draws:
    """A row of the table at each call, of shape (POINTS,)."""

    def __init__(self) -> None:
        self._drawn = 0

    def even(self) -> Floats:
        """Between 0 and 1."""
        self._drawn += 1
        return np.asarray(EVEN[self._drawn % ROWS])

    def normal(self) -> Floats:
        """Of the standard normal distribution."""
        self._drawn += 1
        return np.asarray(NORMAL[self._drawn % ROWS])


def chosen_evenly(weights: Floats) -> Indices:
    """POINTS indices in proportion to their weights (systematic resampling from the middle)."""
    marks = (np.arange(POINTS) + 0.5) / POINTS
    found = np.searchsorted(np.cumsum(weights / weights.sum()), marks)
    return np.minimum(found, len(weights) - 1)
