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

from wayline.likelihood import Floats
from wayline.tuning import Tuning


class VerticalStates:
    """Places in the state vector, with the unit of each; plain numbers are fast to index by."""

    ALTITUDE = 0  # m above mean sea level
    SLOPE = 1  # tan of the slope angle, positive uphill in the direction of travel
    BARO_BIAS = 2  # m, barometric altitude minus altitude
    GPS_ERROR = 3  # m, slowly varying error of the first receiver's altitude; then of the next


S = VerticalStates
ALTITUDE_UNKNOWN_M = 1_000.0
"""Std of an altitude of which nothing is known."""


class Transition(NamedTuple):
    """From one instant to a later one: x' = F x, P' = F P F' + Q."""

    F: Floats
    Q: Floats


class VerticalModel:
    """The model for a number of receivers."""

    def __init__(self, tuning: Tuning, receivers: int) -> None:
        self.size = S.GPS_ERROR + receivers
        self._slope_walk = (tuning.slope_walk_pct_per_sqrt_m / 100.0) ** 2
        self._bias_walk = tuning.baro_bias_walk_m_per_sqrt_s**2
        self._error_time_s = tuning.gps_altitude_error_time_s
        self._slow_share = tuning.gps_altitude_error_share
        self._first_stds = (
            ALTITUDE_UNKNOWN_M,
            tuning.slope_initial_std_pct / 100.0,
            tuning.baro_bias_initial_std_m,
        )

    def first(self) -> tuple[Floats, Floats]:
        """State and covariance before anything is known; of the receivers' errors nothing is yet.

        Shapes (size,) and (size, size).
        """
        P = np.zeros((self.size, self.size))
        for state, std in enumerate(self._first_stds):
            P[state, state] = std**2
        return np.zeros(self.size), P

    def transition(
        self, distance_m: float, elapsed_s: float, slow_stds_m: tuple[float, ...]
    ) -> Transition:
        """Over a distance driven forward (negative in reverse) and the time it took.

        `slow_stds_m` are what each receiver's slow error tends to.
        """
        F, Q = np.eye(self.size), np.zeros((self.size, self.size))
        length, walk = abs(distance_m), self._slope_walk
        F[S.ALTITUDE, S.SLOPE] = distance_m
        Q[S.SLOPE, S.SLOPE] = walk * length
        Q[S.ALTITUDE, S.ALTITUDE] = walk * length**3 / 3.0
        Q[S.ALTITUDE, S.SLOPE] = Q[S.SLOPE, S.ALTITUDE] = walk * length * distance_m / 2.0
        Q[S.BARO_BIAS, S.BARO_BIAS] = self._bias_walk * elapsed_s
        kept = math.exp(-elapsed_s / self._error_time_s)
        for state, std_m in enumerate(slow_stds_m, start=S.GPS_ERROR):
            F[state, state] = kept
            Q[state, state] = (1.0 - kept**2) * std_m**2
        return Transition(F, Q)

    def renewal(self, receiver: int, before_m: float, std_m: float) -> Transition:
        """At once: a receiver's slow error tends to another std from now on.

        A receiver that becomes surer has lost the error it had; one that doubts may have more. So
        a cold start's error of tens of metres is not carried along for minutes.
        """
        F, Q = np.eye(self.size), np.zeros((self.size, self.size))
        state = S.GPS_ERROR + receiver
        if std_m < before_m:
            F[state, state] = std_m / before_m
        else:
            Q[state, state] = std_m**2 - before_m**2
        return Transition(F, Q)

    def shares_m(self, std_m: float) -> tuple[float, float]:
        """The stds of the slow and of the white part of an altitude of a receiver."""
        slow_m2 = self._slow_share * std_m**2
        return math.sqrt(slow_m2), math.sqrt(std_m**2 - slow_m2)
