"""Pure: how altitude, slope and the altimeters' slow errors move (papers/004).

The state is driven over distance, not time: z' = z + ds tan(slope) (eq. 4.11 with the horizontal
distance ds, so that grade = 100 tan(slope)); it is linear, so that no extended filter is needed.
Eq. 4.8 lets the slope stand still; here it changes with a curvature that wanders over the distance
as a first-order Gauss-Markov process, because roads are built of vertical curves. That gives Q
(eq. 5.9) in closed form for any step (`wayline.vertical.road`). The barometer is altitude plus a
wandering bias, which eq. 4.5 leaves out. The error of a receiver's altitude wanders too (R of
eq. 5.11 takes its samples as independent): most of it is a first-order Gauss-Markov state, only a
small share is white.
The engine's push tells of the slope by the mass, which is a state beside the push's own bias.
"""

import math
from typing import Any, NamedTuple

import numpy as np

from wayline.likelihood import Floats, Measurement
from wayline.tuning import Tuning
from wayline.vertical.loading import DOUBT_STD_SHARE
from wayline.vertical.road import Road
from wayline.vertical.states import VerticalStates

S = VerticalStates
Number = Any
"""A float, or floats of as many steps, shape (n,): the formulas are one."""
ALTITUDE_UNKNOWN_M = 1_000.0
"""Std of an altitude of which nothing is known."""
GRAVITY_MPS2 = 9.81
MASS_ALONE_STD = 0.01
"""Of a mass that is taken as it is stated, as a share of it."""
LOADED_AFTER_S = 300.0
"""A vehicle that stands so long may weigh otherwise by as much as is not known of it at first."""
STANDING_MPS = 0.1
"""A vehicle that stands creeps by the noise of its position."""


class Pushed(NamedTuple):
    """What the row of torque needs of a window; the words are those of `Push`."""

    length_s: float
    share: float
    level: float
    behind_m: float = 0.0
    """How far behind the state the window's middle lies."""


class Transition(NamedTuple):
    """From one instant to a later one: x' = F x, P' = F P F' + Q."""

    F: Floats
    Q: Floats


class VerticalModel:
    """The model for a number of receivers, which are counted from 0."""

    def __init__(self, tuning: Tuning, receivers: int = 1) -> None:
        self.receivers = receivers
        self.size = S.GPS_ERROR + receivers
        self._road = Road(tuning.curvature_std_pct_per_m / 100.0, tuning.curvature_length_m)
        self._curvature_std = tuning.curvature_std_pct_per_m / 100.0
        self._bias_walk = tuning.baro_bias_walk_m_per_sqrt_s**2
        self._error_time_s = tuning.gps_altitude_error_time_s
        self._slow_share = tuning.gps_altitude_error_share
        self._slope_std = tuning.slope_initial_std_pct / 100.0
        self._bias_std_m = tuning.baro_bias_initial_std_m
        self._torque_bias_std = tuning.torque_bias_std_pct / 100.0
        self._torque_bias_time_s = tuning.torque_bias_time_s
        # without an altimeter a mass cannot be told from a slope
        has_altimeter = {"gps", "barometer"} & set(tuning.vertical_sensors)
        self._mass_std = tuning.mass_std_share if has_altimeter else MASS_ALONE_STD
        self._loading = self._mass_std**2 / LOADED_AFTER_S
        self.load_std = DOUBT_STD_SHARE if has_altimeter else MASS_ALONE_STD
        """Of the inverse mass after a stand in which a load may have come."""
        self._own_bias_std = tuning.vehicle_slope_bias_std_pct / 100.0

    def first(self) -> tuple[Floats, Floats]:
        """State and covariance before anything is known, shapes (size,) and (size, size)."""
        stds = np.ones(self.size)
        stds[: S.CURVATURE] = ALTITUDE_UNKNOWN_M, self._slope_std, self._bias_std_m
        stds[S.CURVATURE] = self._curvature_std
        stds[S.TORQUE_BIAS : S.SPEED_ERROR] = (
            self._torque_bias_std,
            self._mass_std,
            self._own_bias_std,
        )
        x = np.zeros(self.size)
        x[S.INVERSE_MASS] = 1.0
        return x, np.diag(np.square(stds))

    def transition(self, distance_m: float, elapsed_s: float) -> Transition:
        """Over a distance driven forward (negative in reverse) and the time it took."""
        return self.moved(
            Transition(np.eye(self.size), np.zeros((self.size,) * 2)), distance_m, elapsed_s
        )

    def moved(self, into: Transition, distance_m: float, elapsed_s: float) -> Transition:
        """As `transition`, written over one that was made of this model before."""
        self._road.move(*into, distance_m)
        kept = math.exp(-elapsed_s / self._torque_bias_time_s)
        kept_error = math.exp(-elapsed_s / self._error_time_s)
        self._fade(*into, distance_m, elapsed_s, (kept, kept_error))
        return into

    def moves(self, distances_m: Floats, elapsed_s: Floats, curvature_stds: Floats) -> Transition:
        """As `transition`, of many steps, shape (n,) each: F and Q of shape (n, size, size)."""
        count = len(distances_m)
        F, Q = np.tile(np.eye(self.size), (count, 1, 1)), np.zeros((count, self.size, self.size))
        into = F.transpose(1, 2, 0), Q.transpose(1, 2, 0)
        self._road.moves(*into, distances_m, curvature_stds)
        kept = np.exp(-elapsed_s / self._torque_bias_time_s)
        kept_error = np.exp(-elapsed_s / self._error_time_s)
        self._fade(*into, distances_m, elapsed_s, (kept, kept_error))
        return Transition(F, Q)

    def _fade(
        self,
        F: Floats,
        Q: Floats,
        distance_m: Number,
        elapsed_s: Number,
        kept_shares: tuple[Number, Number],
    ) -> None:
        """Write what time does: of torque's biases and receivers' errors these shares stay."""
        kept, kept_error = kept_shares
        Q[S.BARO_BIAS, S.BARO_BIAS] = self._bias_walk * elapsed_s
        F[S.TORQUE_BIAS, S.TORQUE_BIAS] = F[S.OWN_BIAS, S.OWN_BIAS] = kept
        Q[S.TORQUE_BIAS, S.TORQUE_BIAS] = self._torque_bias_std**2 * (1.0 - kept**2)
        Q[S.OWN_BIAS, S.OWN_BIAS] = self._own_bias_std**2 * (1.0 - kept**2)
        stands = abs(distance_m) <= STANDING_MPS * elapsed_s
        Q[S.INVERSE_MASS, S.INVERSE_MASS] = self._loading * elapsed_s * stands
        for state in range(S.GPS_ERROR, self.size):
            F[state, state], Q[state, state] = kept_error, 1.0 - kept_error**2

    def renewal(self, receiver: int, kept: float) -> Transition:
        """At once: only a part of a receiver's slow error goes on, and a new one comes."""
        F, Q = np.eye(self.size), np.zeros((self.size, self.size))
        state = S.GPS_ERROR + receiver
        F[state, state], Q[state, state] = kept, 1.0 - kept**2
        return Transition(F, Q)

    def handover(self, std_mps: float, *, goes_on: bool) -> Transition:
        """At once: a window of torque begins where the one before ended, or anew.

        Acceleration is a difference of two speeds, and the next window's has one of them: as
        states their errors cancel from window to window.
        """
        handed = Transition(np.eye(self.size), np.zeros((self.size, self.size)))
        return self.handed_over(handed, std_mps, goes_on=goes_on)

    def handed_over(self, moved: Transition, std_mps: float, *, goes_on: bool) -> Transition:
        """A step that ends with a handover, written over the step; driving leaves the errors."""
        F, Q = moved
        now, before = S.SPEED_ERROR, S.SPEED_ERROR_BEFORE
        F[now, now] = F[before, before] = 0.0
        Q[now, now] = std_mps**2
        if goes_on:
            F[before, now] = 1.0
        else:
            Q[before, before] = std_mps**2
        return moved

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

    def torque(self, x: Floats, pushed: Pushed, std: float) -> Measurement:
        """The engine's push over the stated weight, which carries slope and level road.

        level = share / mass - slope - bias, plus the errors of the speeds that the level road's
        acceleration is made of.
        """
        per_mps = 1.0 / (GRAVITY_MPS2 * pushed.length_s)
        y, H, R = np.empty(1), np.zeros((1, self.size)), np.empty((1, 1))
        H[0, S.SLOPE] = H[0, S.TORQUE_BIAS] = -1.0
        H[0, S.CURVATURE] = pushed.behind_m
        H[0, S.INVERSE_MASS] = pushed.share
        H[0, S.SPEED_ERROR], H[0, S.SPEED_ERROR_BEFORE] = per_mps, -per_mps
        y[0] = pushed.level - H[0].dot(x)
        R[0, 0] = std**2
        return Measurement("torque", y, H, R)

    def own_slope(self, x: Floats, slope: float, std: float) -> Measurement:
        """The slope that the vehicle itself reports: the slope plus a bias."""
        y, H, R = np.empty(1), np.zeros((1, self.size)), np.empty((1, 1))
        H[0, S.SLOPE] = H[0, S.OWN_BIAS] = 1.0
        y[0] = slope - x[S.SLOPE] - x[S.OWN_BIAS]
        R[0, 0] = std**2
        return Measurement("vehicle_slope", y, H, R)

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
