"""Pure: how likely a measurement is, and what an unlikely one counts for (chi-square, Huber)."""

from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.special import chdtri

Floats = NDArray[np.float64]


class Measurement(NamedTuple):
    """One linearised measurement: innovation y = H dx + noise of covariance R."""

    sensor: str
    y: Floats
    H: Floats
    R: Floats


@cache
def threshold(dimension: int, probability: float) -> float:
    """Bound of the normalised innovation squared that good measurements pass this often."""
    return float(chdtri(dimension, 1.0 - probability))


def nis_of(measurement: Measurement, expected: Floats) -> float:
    """Normalised innovation squared; `expected` is H P H'."""
    y, noise = measurement.y, measurement.R
    if len(y) == 1:
        return float(y[0]) ** 2 / (float(expected[0, 0]) + float(noise[0, 0]))
    return float(y @ np.linalg.solve(expected + noise, y))


def weighed(measurement: Measurement, expected: Floats, probability: float) -> Measurement:
    """A measurement less likely than `probability`, with so much noise that it is just as likely.

    So what is far off moves the state as far as what is at the bound (Huber), and no farther.
    """
    excess = nis_of(measurement, expected) / threshold(len(measurement.y), probability)
    if excess <= 1.0:
        return measurement
    noise = measurement.R
    return measurement._replace(R=noise + (excess - 1.0) * (expected + noise))
