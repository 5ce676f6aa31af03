"""Pure: the Gaussian kernel smoother of papers/003, equations 3 to 6."""

import numpy as np

from wayline_evaluation.estimates import Floats

BANDWIDTH_S = 3.0
"""h; the paper's rule of thumb (equation 6) gave it 2 to 4 s."""
REACH = 4.0
"""In bandwidths: what is further away weighs a 3,000th."""


def nadaraya_watson(times_s: Floats, measured: Floats, bandwidth_s: float = BANDWIDTH_S) -> Floats:
    """Means weighed by a Gaussian of the time between (equation 4), shape as measured."""
    columns = measured.reshape(len(times_s), -1)
    # the factor before the exponential of equation 3 is in numerator and denominator alike
    summed, weights = columns.copy(), np.ones(len(times_s))
    for offset in range(1, _farthest(times_s, REACH * bandwidth_s) + 1):
        apart_s = times_s[offset:] - times_s[:-offset]
        weight = np.exp(-0.5 * np.square(apart_s / bandwidth_s))
        summed[offset:] += weight[:, np.newaxis] * columns[:-offset]
        summed[:-offset] += weight[:, np.newaxis] * columns[offset:]
        weights[offset:] += weight
        weights[:-offset] += weight
    return np.asarray((summed / weights[:, np.newaxis]).reshape(measured.shape))


def reference_bandwidth(spread: float, count: int) -> float:
    """The normal reference rule (equation 6), in the unit of the std."""
    return float((4.0 / 3.0) ** 0.2 * spread * count**-0.2)


def _farthest(times_s: Floats, reach_s: float) -> int:
    """How many samples lie within the reach of one at the most."""
    last = np.searchsorted(times_s, times_s + reach_s, side="right") - 1
    return int(np.max(last - np.arange(len(times_s))))
