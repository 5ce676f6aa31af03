"""Pure: the least squares spline approximation of papers/003, equations 1 and 2.

Quadratic pieces (d = 3 coefficients) over intervals of three seconds. Pieces by themselves would
pass through three fixes a second apart exactly; joined with continuous slopes, as splines are, they
have one free coefficient an interval, and the least squares of equation 2 smooth.
"""

import numpy as np
from scipy.interpolate import make_lsq_spline

from wayline_evaluation.estimates import Floats

DEGREE = 2
INTERVAL_S = 3.0
SAMPLES_MIN = 3
"""In an interval: as many as a quadratic has coefficients."""


def least_squares_spline(times_s: Floats, measured: Floats) -> Floats:
    """At the instants of the measurements, shape (n,) or (n, axes); at least three of them."""
    inner = _knots_s(times_s)
    knots_s = np.concatenate(
        (np.repeat(times_s[0], DEGREE + 1), inner, np.repeat(times_s[-1], DEGREE + 1))
    )
    spline = make_lsq_spline(times_s, measured, knots_s, k=DEGREE)
    return np.asarray(spline(times_s))


def _knots_s(times_s: Floats) -> Floats:
    """Between the intervals; where a hole is, the next one begins behind it."""
    knots_s = []
    begin = 0
    for at in range(SAMPLES_MIN, len(times_s) - SAMPLES_MIN):
        if at - begin >= SAMPLES_MIN and times_s[at] - times_s[begin] >= INTERVAL_S:
            knots_s.append(times_s[at])
            begin = at
    return np.array(knots_s)
