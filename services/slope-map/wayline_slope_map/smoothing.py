"""Pure: a run's altitude and grade, filtered forwards and smoothed backwards (papers/004).

States (eq. 4.3, 4.4, with the corrections of data/papers): altitude; the slope's tangent, so that
100 times it is the grade; and the slow errors of the two altimeters. Eq. 4.7, z' = u sin(slope),
becomes z' = tan(slope) for each metre of horizontal distance: linear, so that no extended filter
is needed (the paper tried filtering over distance too and saw no difference). Eq. 4.8 lets the
slope stand still; here it walks at random, which gives Q (eq. 5.9) in closed form for any step.
The pressure model's missing offset is the barometer's bias. No time shifts (section 5.2.3): the
backward pass has no lag.

A GPS altitude's error wanders over a minute, so that 1 Hz samples are not independent (R of
eq. 5.11 takes them so): most of it is a state of its own, a first-order Gauss-Markov process that
is driven towards the std that each fix has at its time, and only a small share is white.
"""

from typing import NamedTuple

import numpy as np
from filterpy.kalman import KalmanFilter
from numpy.typing import NDArray

from wayline.line import Floats
from wayline.tuning import Tuning
from wayline_slope_map.altitudes import Measured

ALTITUDE, SLOPE, GPS_ERROR, BARO_BIAS = range(4)
FIRST_ALTITUDE_STD_M = 100.0
FIRST_SLOPE_STD = 0.05
"""Roads seldom climb more than 10 %."""
FIRST_BARO_BIAS_STD_M = 150.0
"""Weather moves the pressure by 40 hPa, which is 340 m from end to end."""
GATE = 9.0
"""Innovations beyond 3 sigma are weighted down so that they move the state like 3 sigma (Huber)."""


class Smoothed(NamedTuple):
    """Altitude and grade with their stds, shape (n,) each."""

    alt_m: Floats
    alt_std_m: Floats
    grade_pct: Floats
    grade_std_pct: Floats


class _Nodes(NamedTuple):
    """The places of a run at which something is measured or asked, in order of travel."""

    times_s: Floats
    travelled_m: Floats
    alt_m: Floats
    std_m: Floats
    """NaN in both where the node is asked only."""
    gps_std_m: Floats
    """Of the fixes around the node; 1 where there are none, for their error is then not seen."""
    barometer: NDArray[np.bool_]
    asked: NDArray[np.intp]
    """For every node the index of what is asked there, -1 where nothing is."""


def smooth(
    gps: Measured, barometer: Measured, times_s: Floats, travelled_m: Floats, tuning: Tuning
) -> Smoothed | None:
    """Smoothed values where asked for, shape (n,); None with fewer than two altitudes.

    The k-th value is asked for at `travelled_m[k]`, reached at `times_s[k]`, in any order.
    """
    if len(gps.alt_m) + len(barometer.alt_m) < 2:
        return None
    nodes = _nodes(gps, barometer, times_s, travelled_m)
    x, P = _smoothed_states(nodes, _first_state(gps, barometer), tuning)
    at = nodes.asked >= 0
    order = np.argsort(nodes.asked[at])
    x, P = x[at][order], P[at][order]
    return Smoothed(
        alt_m=x[:, ALTITUDE],
        alt_std_m=np.sqrt(P[:, ALTITUDE, ALTITUDE]),
        grade_pct=100.0 * x[:, SLOPE],
        grade_std_pct=100.0 * np.sqrt(P[:, SLOPE, SLOPE]),
    )


def _nodes(gps: Measured, barometer: Measured, times_s: Floats, travelled_m: Floats) -> _Nodes:
    asked = len(times_s)
    nothing = np.full(asked, np.nan)
    times = np.concatenate((gps.times_s, barometer.times_s, times_s))
    travelled = np.concatenate((gps.travelled_m, barometer.travelled_m, travelled_m))
    order = np.lexsort((times, travelled))
    counts = [len(gps.alt_m), len(barometer.alt_m), asked]
    measured = counts[0] + counts[1]
    return _Nodes(
        times[order],
        travelled[order],
        np.concatenate((gps.alt_m, barometer.alt_m, nothing))[order],
        np.concatenate((gps.std_m, barometer.std_m, nothing))[order],
        np.interp(times, gps.times_s, gps.std_m)[order] if counts[0] else np.ones(len(times)),
        np.repeat([False, True, False], counts)[order],
        np.concatenate((np.full(measured, -1), np.arange(asked)))[order],
    )


def _first_state(gps: Measured, barometer: Measured) -> Floats:
    """Medians of the first altitudes, because any one of them may be far out."""
    x = np.zeros(4)
    barometer_m = float(np.median(barometer.alt_m[:15])) if len(barometer.alt_m) else 0.0
    x[ALTITUDE] = float(np.median(gps.alt_m[:15])) if len(gps.alt_m) else barometer_m
    if len(barometer.alt_m):
        x[BARO_BIAS] = barometer_m - x[ALTITUDE]
    return x


def _smoothed_states(nodes: _Nodes, first: Floats, tuning: Tuning) -> tuple[Floats, Floats]:
    """States (n, 4) and covariances (n, 4, 4) given all measurements, before and after."""
    kalman = KalmanFilter(dim_x=4, dim_z=1)
    kalman.x = first
    kalman.P = np.diag(
        np.square(
            [
                FIRST_ALTITUDE_STD_M,
                FIRST_SLOPE_STD,
                nodes.gps_std_m[0],
                FIRST_BARO_BIAS_STD_M,
            ]
        )
    )
    F, Q = _transitions(nodes, tuning)
    x, P = np.empty((len(F), 4)), np.empty((len(F), 4, 4))
    for k in range(len(F)):
        kalman.predict(F=F[k], Q=Q[k])
        if not np.isnan(nodes.alt_m[k]):
            _update(kalman, nodes.alt_m[k], nodes.std_m[k], nodes.barometer[k], tuning)
        x[k], P[k] = kalman.x, kalman.P
    smoothed_x, smoothed_P, _, _ = kalman.rts_smoother(x, P, Fs=F, Qs=Q)
    return smoothed_x, smoothed_P


def _transitions(nodes: _Nodes, tuning: Tuning) -> tuple[Floats, Floats]:
    """F and Q from each node's predecessor, shape (n, 4, 4): eq. 5.5 and 5.9 over distance."""
    steps_m = np.maximum(np.diff(nodes.travelled_m, prepend=nodes.travelled_m[0]), 0.0)
    steps_s = np.maximum(np.diff(nodes.times_s, prepend=nodes.times_s[0]), 0.0)
    F = np.tile(np.eye(4), (len(steps_m), 1, 1))
    F[:, ALTITUDE, SLOPE] = steps_m
    F[:, GPS_ERROR, GPS_ERROR] = np.exp(-steps_s / tuning.map_gps_error_time_s)
    walk = (tuning.map_slope_walk_pct_per_sqrt_m / 100.0) ** 2
    Q = np.zeros_like(F)
    Q[:, ALTITUDE, ALTITUDE] = walk * steps_m**3 / 3.0
    Q[:, ALTITUDE, SLOPE] = Q[:, SLOPE, ALTITUDE] = walk * steps_m**2 / 2.0
    Q[:, SLOPE, SLOPE] = walk * steps_m
    wander_m2 = nodes.gps_std_m**2 * (1.0 - tuning.map_gps_white_share**2)
    Q[:, GPS_ERROR, GPS_ERROR] = wander_m2 * (1.0 - F[:, GPS_ERROR, GPS_ERROR] ** 2)
    Q[:, BARO_BIAS, BARO_BIAS] = tuning.map_barometer_walk_m_per_sqrt_s**2 * steps_s
    return F, Q


def _update(
    kalman: KalmanFilter, alt_m: float, std_m: float, barometer: bool, tuning: Tuning
) -> None:
    """One altitude in (eq. 4.25 to 4.27), with H of eq. 4.5 and the sensor's own error."""
    H = np.zeros((1, 4))
    H[0, ALTITUDE] = 1.0
    if barometer:
        H[0, BARO_BIAS] = 1.0
        R = std_m**2
    else:
        H[0, GPS_ERROR] = 1.0
        R = (tuning.map_gps_white_share * std_m) ** 2
    innovation_m = alt_m - float((H @ kalman.x)[0])
    S = float((H @ kalman.P @ H.T)[0, 0]) + R
    excess = innovation_m**2 / S / GATE
    if excess > 1.0:
        R += S * (excess**0.5 - 1.0)
    kalman.update(np.array([alt_m]), R=R, H=H)
