"""Pure: the modified Kalman filter of papers/003: another R where satellites or PDOP are bad.

Good is at least four satellites and a PDOP of eight at most; the discrete filter's Q and R hold
there. Bad fixes have the noise that the paper found by trial: all but ignored.
"""

import numpy as np
from numpy.typing import NDArray

from wayline_evaluation.estimates import Floats
from wayline_evaluation.smoothing.kalman import MPH_MPS, filtered

MILE_M = 1_609.344
BAD_POSITION_VARIANCE_M2 = (690.0 * MILE_M) ** 2
"""Ten degrees."""
BAD_SPEED_VARIANCE_M2PS2 = (10.0 * MPH_MPS) ** 2


def modified_kalman(
    times_s: Floats,
    measured: Floats,
    good: NDArray[np.bool_],
    *,
    variance: float,
    bad_variance: float,
) -> Floats:
    """The discrete filter with R by quality; `good` has shape (n,), the variances are R."""
    return filtered(times_s, measured, np.where(good, variance, bad_variance), variance)
