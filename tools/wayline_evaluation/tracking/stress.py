"""Pure: how jerky a carrier is, and how narrow a loop an aid allows."""

from typing import NamedTuple

import numpy as np
from scipy.signal import savgol_filter

from wayline_evaluation.estimates import Floats
from wayline_evaluation.tracking.fll import ORDER, allowed_bandwidth_hz
from wayline_evaluation.tracking.loop import SAMPLES_HZ

DEGREE = 3
LARGEST_SHARE = 0.997
"""Of the time jerk is no larger: the largest of three sigma."""


class Allowed(NamedTuple):
    """What an aid takes off a loop."""

    jerk_hzps2: float
    """Of the carrier."""
    left_hzps2: float
    """Of what the aid leaves of it."""
    bandwidth_hz: float


def jerk_hzps2(frequencies_hz: Floats, bandwidth_hz: float) -> float:
    """Largest second derivative of carriers, shape (samples, runs), as a loop would feel it.

    Cubics are fitted over the loop's own time, 1 / bandwidth: what is over sooner does not stress
    it, and is bounded by its size.
    """
    window = 2 * round(0.5 * SAMPLES_HZ / bandwidth_hz) + 1
    jerks_hzps2 = savgol_filter(
        frequencies_hz, window, DEGREE, deriv=2, delta=1.0 / SAMPLES_HZ, axis=0
    )
    return float(np.quantile(np.abs(jerks_hzps2), LARGEST_SHARE))


def allowed(moved_hz: Floats, told_hz: Floats, bandwidth_hz: float) -> Allowed:
    """Beside a loop that is told nothing; carriers by motion alone, shape (samples, runs).

    The clock is left out as in the paper: what it does to a loop no aid takes away.
    """
    whole = jerk_hzps2(moved_hz, bandwidth_hz)
    left = jerk_hzps2(moved_hz - told_hz, bandwidth_hz)
    return Allowed(whole, left, allowed_bandwidth_hz(bandwidth_hz, left / whole))


def widened_hz(narrow_hz: float, std_ratio: float, unaided_hz: float) -> float:
    """What a receiver makes of an aid that says it is `std_ratio` times worse than usual.

    The aid's error is as much jerkier (equation 3); wider than without an aid no loop need be.
    """
    return min(narrow_hz * float(max(std_ratio, 1.0) ** (1.0 / ORDER)), unaided_hz)
