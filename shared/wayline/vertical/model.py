"""Pure: how altitude, slope and the altimeters' slow errors move (papers/004).

The state is driven over distance, not time: z' = z + ds tan(slope) (eq. 4.11 with the horizontal
distance ds, so that grade = 100 tan(slope)); it is linear, so that no extended filter is needed.
Eq. 4.8 lets the slope stand still; here it walks at random over the distance, which gives Q
(eq. 5.9) in closed form for any step. The barometer is altitude plus a wandering bias, which
eq. 4.5 leaves out. The error of a receiver's altitude wanders too (R of eq. 5.11 takes its samples
as independent): most of it is a first-order Gauss-Markov state, only a small share is white.
"""

import math
from typing import NamedTuple

import numpy as np

from wayline.likelihood import Floats, Measurement
from wayline.tuning import Tuning


class VerticalStates:
    """Places in the state vector, with the unit of each; plain numbers are fast to index by."""

    ALTITUDE = 0  # m above mean sea level
    SLOPE = 1  # tan of the slope angle, positive uphill in the direction of travel
    BARO_BIAS = 2  # m, barometric altitude minus altitude
    GPS_ERROR = 3  # slow error of the first receiver's altitude, in its own stds; then the next's


S = VerticalStates
ALTITUDE_UNKNOWN_M = 1_000.0
"""Std of an altitude of which nothing is known."""


class Transition(NamedTuple):
    """From one instant to a later one: x' = F x, P' = F P F' + Q."""

    F: Floats
    Q: Floats


class VerticalModel:
    """The model for a number of receivers, which are counted from 0."""

    def __init__(self, tuning: Tuning, receivers: int = 1) -> None:
        self.receivers = receivers
        self.size = S.GPS_ERROR + receivers
        self._slope_walk = (tuning.slope_walk_pct_per_sqrt_m / 100.0) ** 2
        self._bias_walk = tuning.baro_bias_walk_m_per_sqrt_s**2
        self._error_time_s = tuning.gps_altitude_error_time_s
        self._slow_share = tuning.gps_altitude_error_share
        self._slope_std = tuning.slope_initial_std_pct / 100.0
        self._bias_std_m = tuning.baro_bias_initial_std_m

    def first(self) -> tuple[Floats, Floats]:
        """State and covariance before anything is known, shapes (size,) and (size, size)."""
        stds = np.ones(self.size)
        stds[: S.GPS_ERROR] = ALTITUDE_UNKNOWN_M, self._slope_std, self._bias_std_m
        return np.zeros(self.size), np.diag(np.square(stds))

    def transition(self, distance_m: float, elapsed_s: float) -> Transition:
        """Over a distance driven forward (negative in reverse) and the time it took."""
        return self.moved(
            Transition(np.eye(self.size), np.zeros((self.size,) * 2)), distance_m, elapsed_s
        )

    def moved(self, into: Transition, distance_m: float, elapsed_s: float) -> Transition:
        """As `transition`, written over one that was made of this model before."""
        F, Q = into
        length, walk = abs(distance_m), self._slope_walk
        F[S.ALTITUDE, S.SLOPE] = distance_m
        Q[S.SLOPE, S.SLOPE] = walk * length
        Q[S.ALTITUDE, S.ALTITUDE] = walk * length**3 / 3.0
        Q[S.ALTITUDE, S.SLOPE] = Q[S.SLOPE, S.ALTITUDE] = walk * length * distance_m / 2.0
        Q[S.BARO_BIAS, S.BARO_BIAS] = self._bias_walk * elapsed_s
        kept = math.exp(-elapsed_s / self._error_time_s)
        for state in range(S.GPS_ERROR, self.size):
            F[state, state], Q[state, state] = kept, 1.0 - kept**2
        return into

    def renewal(self, receiver: int, kept: float) -> Transition:
        """At once: only a part of a receiver's slow error goes on, and a new one comes."""
        F, Q = np.eye(self.size), np.zeros((self.size, self.size))
        state = S.GPS_ERROR + receiver
        F[state, state], Q[state, state] = kept, 1.0 - kept**2
        return Transition(F, Q)

    def slow_std_m(self, std_m: float) -> float:
        """The part of the std of a receiver's altitude that varies slowly."""
        return math.sqrt(self._slow_share) * std_m

    def gps_altitude(self, x: Floats, receiver: int, alt_m: float, std_m: float) -> Measurement:
        """A receiver's altitude: the altitude plus its slow error, plus white noise."""
        slow_std_m = self.slow_std_m(std_m)
        white_std_m = math.sqrt(std_m**2 - slow_std_m**2)
        by_error = (S.GPS_ERROR + receiver, slow_std_m)
        return self._measured("gps_altitude", x, alt_m, by_error, white_std_m)

    def barometer(self, x: Floats, alt_m: float, std_m: float) -> Measurement:
        """Barometric altitude: the altitude plus the bias of weather and sensor."""
        return self._measured("barometer", x, alt_m, (S.BARO_BIAS, 1.0), std_m)

    def _measured(
        self, sensor: str, x: Floats, alt_m: float, by_error: tuple[int, float], std_m: float
    ) -> Measurement:
        """An altitude off by an error: its place in the state, and what one of it makes in m."""
        error, gain = by_error
        y, H, R = np.empty(1), np.zeros((1, self.size)), np.empty((1, 1))
        H[0, S.ALTITUDE], H[0, error] = 1.0, gain
        y[0] = alt_m - x[S.ALTITUDE] - gain * x[error]
        R[0, 0] = std_m**2
        return Measurement(sensor, y, H, R)
