"""Pure: the horizontal filter of papers/001 on numpy arrays; filterpy does the Kalman algebra.

Frame: a local plane, east and north in metres; heading clockwise from north in radians.
The Gauss-Markov and random-walk models are those of papers/001, "Loose coupling"; the paper gives
no variances, ours and their reasons are in `wayline.tuning`.
"""

import math
from typing import NamedTuple

import numpy as np
from filterpy.kalman import KalmanFilter

from wayline.geo import wrap_pi
from wayline.tuning import Tuning
from wayline_fusion.measurements import Measurement
from wayline_fusion.states import SIZE, Floats, States

S = States


class DrivingNoise(NamedTuple):
    """What is known of this gyro beyond the configuration."""

    turn_rad_per_sqrt_s: float
    bias_walk: float
    """Of the gyro bias, rad/s per root s."""


class HorizontalFilter(KalmanFilter):  # type: ignore[misc]
    """Extended Kalman filter over `States`: filterpy's, given what is linearised here."""

    def __init__(self, tuning: Tuning) -> None:
        super().__init__(dim_x=SIZE, dim_z=2)
        self._tuning = tuning
        self.x = np.zeros(SIZE)
        self.x[S.GYRO_SCALE] = self.x[S.ODOMETER_SCALE] = 1.0
        self.P = np.diag(np.square(self._initial_stds()))
        self.F = np.eye(SIZE)
        self.Q = np.zeros((SIZE, SIZE))
        self._variances = self.Q.reshape(-1)[:: SIZE + 1]
        """The diagonal of Q."""
        self.inv = _inverse

    def _initial_stds(self) -> list[float]:
        tuning = self._tuning
        return [
            1e4,
            1e4,
            math.pi,
            40.0,
            math.radians(tuning.gyro_bias_initial_std_degps),
            tuning.gyro_scale_initial_std,
            tuning.odometer_scale_initial_std,
            1.0,
            1.0,
            tuning.gps_latency_std_s,
        ]

    def advance(
        self, dt_s: float, turn_rad: float | None, noise: DrivingNoise, *, standing: bool
    ) -> None:
        """Predict over a step of at most a few tenths of a second.

        `turn_rad` is the measured, uncorrected turn; None without a gyro. Standing still, heading
        is held and position keeps its value.
        """
        # numpy's own numbers are slow to calculate with
        x, F = self.x.tolist(), self.F
        heading, speed, bias, scale = x[S.HEADING], x[S.SPEED], x[S.GYRO_BIAS], x[S.GYRO_SCALE]
        measured = turn_rad is not None and not standing
        turned = 0.0 if turn_rad is None or standing else turn_rad - bias * dt_s
        middle = heading + 0.5 * scale * turned
        sin, cos = math.sin(middle), math.cos(middle)
        moved = speed * dt_s

        heading_by_bias = -scale * dt_s if measured else 0.0
        heading_by_scale = turned if measured else 0.0
        east_by_heading, north_by_heading = moved * cos, -moved * sin
        F[S.EAST, S.HEADING], F[S.NORTH, S.HEADING] = east_by_heading, north_by_heading
        F[S.EAST, S.SPEED], F[S.NORTH, S.SPEED] = dt_s * sin, dt_s * cos
        F[S.HEADING, S.GYRO_BIAS], F[S.HEADING, S.GYRO_SCALE] = heading_by_bias, heading_by_scale
        F[S.EAST, S.GYRO_BIAS] = 0.5 * east_by_heading * heading_by_bias
        F[S.EAST, S.GYRO_SCALE] = 0.5 * east_by_heading * heading_by_scale
        F[S.NORTH, S.GYRO_BIAS] = 0.5 * north_by_heading * heading_by_bias
        F[S.NORTH, S.GYRO_SCALE] = 0.5 * north_by_heading * heading_by_scale
        kept = math.exp(-dt_s / self._tuning.gps_error_time_s)
        F[S.GPS_EAST, S.GPS_EAST] = F[S.GPS_NORTH, S.GPS_NORTH] = kept
        self._set_noise(dt_s, noise, gyro=turn_rad is not None, standing=standing)
        self._variances[S.GPS_EAST] = self._variances[S.GPS_NORTH] = 1.0 - kept**2
        self.predict()
        # the state itself moves by the model, not by its linearisation
        x[S.EAST] += moved * sin
        x[S.NORTH] += moved * cos
        x[S.HEADING] += scale * turned
        x[S.GPS_EAST] *= kept
        x[S.GPS_NORTH] *= kept
        self.x = np.array(x)

    def _set_noise(self, dt_s: float, noise: DrivingNoise, *, gyro: bool, standing: bool) -> None:
        tuning, variances = self._tuning, self._variances
        if standing:
            position_mps2, heading, acceleration = 0.0, 0.0, 0.05
        else:
            position_mps2 = tuning.position_noise_m_per_sqrt_s**2
            without_gyro = math.radians(tuning.turn_noise_deg_per_sqrt_s)
            heading = noise.turn_rad_per_sqrt_s if gyro else without_gyro
            acceleration = tuning.acceleration_noise_mps_per_sqrt_s
        variances[S.EAST] = variances[S.NORTH] = position_mps2 * dt_s
        variances[S.HEADING] = heading**2 * dt_s
        variances[S.SPEED] = acceleration**2 * dt_s
        variances[S.GYRO_BIAS] = noise.bias_walk**2 * dt_s
        variances[S.GYRO_SCALE] = tuning.gyro_scale_walk_per_sqrt_s**2 * dt_s
        variances[S.ODOMETER_SCALE] = tuning.odometer_scale_walk_per_sqrt_s**2 * dt_s

    def expected(self, measurement: Measurement) -> Floats:
        """Covariance of the innovation without the measurement's own noise, H P H'."""
        H = measurement.H
        # for matrices as small as these `dot` takes a third of the time of @
        predicted: Floats = H.dot(self.P).dot(H.T)
        return predicted

    def correct(self, measurement: Measurement) -> None:
        """Update the state with a measurement that was linearised at it."""
        H = measurement.H
        # filterpy takes H x off again, which leaves the innovation
        z = measurement.y + H.dot(self.x)
        # filterpy keeps a deep copy, which a plain number does not need
        self.update(float(z[0]) if len(z) == 1 else z, measurement.R, H)
        self.x[S.HEADING] = wrap_pi(float(self.x[S.HEADING]))

    def place(self, east_m: float, north_m: float, std_m: float, doubt_m: float = 0.0) -> None:
        """Set the position to a fix, forgetting where it was (start, or after a lock-out).

        `doubt_m` is the std of a displacement that this fix and those that follow may share.
        """
        slow_std_m = self.slow_std_m(std_m)
        self.x, self.P = self.x.copy(), self.P.copy()
        for axis, error, value in (
            (S.EAST, S.GPS_EAST, east_m),
            (S.NORTH, S.GPS_NORTH, north_m),
        ):
            for state in (axis, error):
                self.P[state, :] = self.P[:, state] = 0.0
            self.x[axis], self.x[error] = value, 0.0
            shared_m2 = slow_std_m**2 + doubt_m**2
            self.P[axis, axis] = std_m**2 + doubt_m**2
            self.P[error, error] = shared_m2 / slow_std_m**2
            self.P[axis, error] = self.P[error, axis] = -shared_m2 / slow_std_m

    def renew_fixes_error(self, kept: float) -> None:
        """Let only a part of the fixes' slow error go on, and a new one come."""
        self.x, self.P = self.x.copy(), self.P.copy()
        for error in (S.GPS_EAST, S.GPS_NORTH):
            self.x[error] *= kept
            self.P[error, :] *= kept
            self.P[:, error] *= kept
            self.P[error, error] += 1.0 - kept**2

    def turn_to(self, heading_rad: float, std_rad: float) -> None:
        """Set the heading, forgetting what it was."""
        self.x, self.P = self.x.copy(), self.P.copy()
        self.x[S.HEADING] = wrap_pi(heading_rad)
        self.P[S.HEADING, :] = self.P[:, S.HEADING] = 0.0
        self.P[S.HEADING, S.HEADING] = std_rad**2

    def forget_motion(self) -> None:
        """Forget position, heading, speed and the fixes' error; keep the sensors' calibration."""
        self.x, self.P = self.x.copy(), self.P.copy()
        initial = np.square(self._initial_stds())
        for state in (S.EAST, S.NORTH, S.HEADING, S.SPEED, S.GPS_EAST, S.GPS_NORTH):
            self.x[state] = 0.0
            self.P[state, :] = self.P[:, state] = 0.0
            self.P[state, state] = initial[state]

    def go_forward(self) -> None:
        """Forget a speed that noise made negative, where no wheel has said reverse."""
        self.x, self.P = self.x.copy(), self.P.copy()
        self.x[S.SPEED] = 0.0
        self.P[S.SPEED, :] = self.P[:, S.SPEED] = 0.0
        self.P[S.SPEED, S.SPEED] = self._tuning.acceleration_noise_mps_per_sqrt_s**2

    def doubt(self, state: int, std: float) -> None:
        """Keep a value and trust it no more than this."""
        self.P = self.P.copy()
        self.P[state, :] = self.P[:, state] = 0.0
        self.P[state, state] = std**2

    def stray(self, std_m: float) -> None:
        """Trust the position less: dead reckoning has gone astray by about so much."""
        self.P = self.P.copy()
        self.P[S.EAST, S.EAST] += std_m**2
        self.P[S.NORTH, S.NORTH] += std_m**2

    def std(self, state: int) -> float:
        """One sigma of a state."""
        variance: float = self.P.item(state, state)
        return 0.0 if variance < 0.0 else math.sqrt(variance)

    def slow_std_m(self, std_m: float) -> float:
        """The part of a fix's std that varies slowly."""
        return math.sqrt(self._tuning.gps_error_share) * std_m


def _inverse(S: Floats) -> np.ndarray:
    """Of an innovation's covariance, which is mostly a single number."""
    return 1.0 / S if len(S) == 1 else np.linalg.inv(S)
