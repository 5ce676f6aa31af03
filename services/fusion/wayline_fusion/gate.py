"""Pure: the chi-square gate. A measurement too unlikely for its stds is rejected, and said so."""

from functools import cache

import numpy as np
from scipy.special import chdtri

from wayline.messages import Verdict
from wayline_fusion.measurements import Measurement
from wayline_fusion.states import Floats


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


def judge(sensor: str, t_ns: int, nis: float, dimension: int, probability: float) -> Verdict:
    """Accept or reject a measurement by its normalised innovation squared."""
    limit = threshold(dimension, probability)
    accepted = nis <= limit
    reason = None if accepted else "too far from the prediction for its and the filter's stds"
    return Verdict(
        sensor=sensor, t_ns=t_ns, accepted=accepted, nis=nis, threshold=limit, reason=reason
    )
