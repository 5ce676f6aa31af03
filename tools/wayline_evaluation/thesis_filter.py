"""Pure: the published extended Kalman filter of papers/004, chapters 4 and 5.

States are altitude and slope, once a second, the speed is an input (eq. 4.11); each sensor is
tried alone by multiplying the others' noise by 1e10 (eq. 5.16).

The paper does not print Q. Here it acts on the slope alone and makes the filter lag by what the
paper had to shift its curves (section 5.2.3): 10 s for the torque sensor, 16 s for the
barometer; of the GPS's 12 s the receiver's own filter has 2, which leaves the torque sensor's 10.
That share is a judgement: one Q for all three sensors cannot give these lags, so each was tuned.
"""

import math
from collections.abc import Sequence
from typing import Literal

import numpy as np

from wayline.air import pressure_altitude_m
from wayline_evaluation.estimates import Floats
from wayline_evaluation.gaussian import Gaussian
from wayline_evaluation.motion import integral
from wayline_evaluation.sensed import Sensed, Series

Sensor = Literal["gps", "barometer", "torque"]
SENSORS: tuple[Sensor, ...] = ("gps", "barometer", "torque")
VARIANCES = {"gps": 16.0, "barometer": 4.0, "torque": 0.1e-4}
"""R (eq. 5.11 to 5.13) in m2, m2 of altitude, and 0.1 %2 as a squared tangent."""
IGNORED = 1e10
"""R of what is shut out is this much larger (eq. 5.16)."""
LAGS_S = {"gps": 10.0, "barometer": 16.0, "torque": 10.0}
"""Of the filter alone."""
SHIFTS_S = {"gps": 12.0, "barometer": 16.0, "torque": 10.0}
"""By which the paper moved its curves back (section 5.2.3)."""
CRUISE_MPS = 22.2
"""80 km/h, a truck's speed on both roads: the speed at which the lags of altitudes hold."""
INVALID_PCT = 13.0
"""What the vehicle reports while the wheel brakes are applied (section 3.3)."""
STEP_S = 1.0


def slope_noise(sensor: Sensor) -> float:
    """Variance that a second adds to the slope so that the filter's steady state lags as it shall.

    An altitude's filter is a double integrator with corners at w = (q u^2 / R)^(1/4), its slope
    lags by sqrt(2) / w; a slope's is a first-order one of gain K, which lags by (1 - K) / K steps.
    """
    lag_s, variance = LAGS_S[sensor], VARIANCES[sensor]
    if sensor == "torque":
        gain = 1.0 / (1.0 + lag_s / STEP_S)
        return variance * gain**2 / (1.0 - gain)
    corner_radps = math.sqrt(2.0) / lag_s
    return variance * corner_radps**4 / CRUISE_MPS**2


def measured(sensed: Sensed, times_s: Floats) -> dict[Sensor, Floats]:
    """Altitudes (m) and slope (a tangent) at instants, nan where there is none that is new."""
    alts = [(fix.t_ns * 1e-9, fix.alt_m) for fix in sensed.fixes if fix.alt_m is not None]
    gps = Series(np.array([time_s for time_s, _ in alts]), np.array([alt_m for _, alt_m in alts]))
    pressures = sensed.pressure_pa
    heights_m = np.array([pressure_altitude_m(float(value)) for value in pressures.values])
    slope = sensed.slope_pct
    known = slope.values < INVALID_PCT
    return {
        "gps": _latest(gps, times_s),
        "barometer": _latest(Series(pressures.times_s, heights_m), times_s),
        "torque": _latest(Series(slope.times_s[known], slope.values[known] / 100.0), times_s),
    }


def thesis_slopes_pct(
    measurements: dict[Sensor, Floats], speeds_mps: Floats, sensor: Sensor
) -> Floats:
    """The slope after every second from one sensor alone; nan before it said anything."""
    noise = np.array([0.0, slope_noise(sensor)])
    kinds: Sequence[Sensor] = SENSORS
    rows = {"gps": [1.0, 0.0], "barometer": [1.0, 0.0], "torque": [0.0, 1.0]}
    told = np.flatnonzero(~np.isnan(measurements[sensor]))
    slopes_pct = np.full(len(speeds_mps), np.nan)
    if len(told) == 0:
        return slopes_pct
    first_m = measurements[sensor][told[0]] if sensor != "torque" else 0.0
    state = Gaussian(np.array([first_m, 0.0]), np.array([4.0, 0.05]))
    for second in range(int(told[0]), len(speeds_mps)):
        moved_m = float(speeds_mps[max(second - 1, 0)]) * STEP_S
        altitude_m, slope_rad = state.mean
        transition = np.array([[1.0, moved_m * math.cos(slope_rad)], [0.0, 1.0]])
        climbed = np.array([altitude_m + moved_m * math.sin(slope_rad), slope_rad])
        state.advance(climbed, transition, noise)
        given = [kind for kind in kinds if not np.isnan(measurements[kind][second])]
        if given:
            matrix = np.array([rows[kind] for kind in given])
            factors = [1.0 if kind == sensor else IGNORED for kind in given]
            variances = [VARIANCES[kind] * by for kind, by in zip(given, factors, strict=True)]
            values = np.array([measurements[kind][second] for kind in given])
            state.correct(values - matrix @ state.mean, matrix, np.diag(variances))
        slopes_pct[second] = 100.0 * math.tan(state.mean[1])
    return slopes_pct


def seconds_of(sensed: Sensed) -> Floats:
    """Instants of the filter over a drive."""
    return np.arange(np.ceil(sensed.start_s), sensed.end_s, STEP_S)


def mean_speeds_mps(sensed: Sensed, times_s: Floats) -> Floats:
    """Wheel speed over the second after each instant."""
    driven_m = integral(sensed.speed_mps, np.append(times_s, times_s[-1] + STEP_S))
    return np.diff(driven_m) / STEP_S


def _latest(series: Series, times_s: Floats) -> Floats:
    """The newest value of the second before each instant."""
    if len(series) == 0:
        return np.full(len(times_s), np.nan)
    place = np.searchsorted(series.times_s, times_s, "right") - 1
    known = place >= 0
    ages_s = times_s - series.times_s[np.maximum(place, 0)]
    fresh = known & (ages_s < STEP_S)
    return np.where(fresh, series.values[np.maximum(place, 0)], np.nan)
