"""Pure: the discrete Kalman filter of papers/003, equations 7 to 16, one quantity at a time.

The paper sets A = H = 1 and u = 0 (equations 9, 10 and 14 to 16), so a filter of one number is all
there is; written out it costs a hundredth of a call of filterpy's, which a test holds it equal to.
"""

import numpy as np

from wayline_evaluation.estimates import Floats

FOOT_M = 0.3048
MPH_MPS = 0.44704
POSITION_VARIANCE_M2 = (10.0 * FOOT_M) ** 2
"""R: the square of the data sheet's mean error."""
SPEED_VARIANCE_M2PS2 = (0.5 * MPH_MPS) ** 2
"""R: the square of the mean difference between GPS and wheels, 1,171,496 of them."""


def discrete_kalman(times_s: Floats, measured: Floats, variance: float) -> Floats:
    """The filter with one measurement noise R, and Q = R times the square of the seconds between.

    `measured` is (n,) or (n, axes), `variance` R in the square of its unit.
    """
    return filtered(times_s, measured, np.full(len(times_s), variance), variance)


def filtered(times_s: Floats, measured: Floats, variances: Floats, process: float) -> Floats:
    """Equations 9, 10 and 14 to 16; R of each measurement, Q of a step of one second."""
    gains = _gains(np.diff(times_s, prepend=times_s[0]).tolist(), variances.tolist(), process)
    columns = [_followed(column.tolist(), gains) for column in np.atleast_2d(measured.T)]
    return np.asarray(columns).T.reshape(measured.shape)


def _gains(steps_s: list[float], variances: list[float], process: float) -> list[float]:
    """K of each measurement; nothing is known before the first."""
    gains, P = [1.0], variances[0]
    for dt_s, R in zip(steps_s[1:], variances[1:], strict=True):
        P += process * dt_s * dt_s  # equation 10
        K = P / (P + R)  # equation 14
        P *= 1.0 - K  # equation 16
        gains.append(K)
    return gains


def _followed(measured: list[float], gains: list[float]) -> list[float]:
    x = measured[0]
    states = []
    for z, K in zip(measured, gains, strict=True):
        x += K * (z - x)  # equations 9 and 15
        states.append(x)
    return states
