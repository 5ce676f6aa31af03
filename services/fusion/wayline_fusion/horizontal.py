"""Pure: the horizontal filter of papers/001 on numpy arrays; filterpy does the Kalman algebra.

Frame: a local plane, east and north in metres; heading clockwise from north in radians.
The Gauss-Markov and random-walk models are those of papers/001, "Loose coupling"; the paper gives
no variances, ours and their reasons are in `wayline.tuning`.
"""

import math
from enum import IntEnum
from typing import NamedTuple

import numpy as np
from filterpy.kalman import ExtendedKalmanFilter
from numpy.typing import NDArray

from wayline.geo import wrap_pi
from wayline.tuning import Tuning

Floats = NDArray[np.float64]


class States(IntEnum):
    """Places in the state vector, with the unit of each."""

    EAST = 0  # m
    NORTH = 1  # m
    HEADING = 2  # rad
    SPEED = 3  # m/s, negative in reverse
    GYRO_BIAS = 4  # rad/s
    GYRO_SCALE = 5
    ODOMETER_SCALE = 6
    GPS_EAST = 7  # slowly varying error of the fixes, in their own stds
    GPS_NORTH = 8


S = States


class Measurement(NamedTuple):
    """One linearised measurement: z = hx + H dx + noise of covariance R."""

    sensor: str
    z: Floats
    hx: Floats
    H: Floats
    R: Floats
    angular: bool = False


class HorizontalFilter(ExtendedKalmanFilter):  # type: ignore[misc]
    """Extended Kalman filter over `States`."""

    def __init__(self, tuning: Tuning) -> None:
        super().__init__(dim_x=len(States), dim_z=2)
        self._tuning = tuning
        self.x = np.zeros(len(States))
        self.x[S.GYRO_SCALE] = self.x[S.ODOMETER_SCALE] = 1.0
        self.P = np.diag(np.square(self._initial_stds()))
        self.F = np.eye(len(States))
        self.Q = np.zeros((len(States), len(States)))
        self._step = np.zeros(len(States))

    def _initial_stds(self) -> list[float]:
        tuning = self._tuning
        return [
            1e4,
            1e4,
            math.pi,
            1.0,
            math.radians(tuning.gyro_bias_initial_std_degps),
            tuning.gyro_scale_initial_std,
            tuning.odometer_scale_initial_std,
            1.0,
            1.0,
        ]

    def advance(self, dt_s: float, turn_rad: float | None, *, standing: bool) -> None:
        """Predict over a step of at most a few tenths of a second.

        `turn_rad` is the measured, uncorrected turn; None without a gyro. Standing still, heading
        is held and position keeps its value.
        """
        x, F = self.x, self.F
        bias, scale, speed = x[S.GYRO_BIAS], x[S.GYRO_SCALE], x[S.SPEED]
        measured = turn_rad is not None and not standing
        turned = 0.0 if turn_rad is None or standing else turn_rad - bias * dt_s
        middle = x[S.HEADING] + 0.5 * scale * turned
        sin, cos = math.sin(middle), math.cos(middle)
        moved = speed * dt_s
        step = self._step
        step[S.EAST], step[S.NORTH] = moved * sin, moved * cos
        step[S.HEADING] = scale * turned

        heading_by_bias = -scale * dt_s if measured else 0.0
        heading_by_scale = turned if measured else 0.0
        east_by_heading, north_by_heading = moved * cos, -moved * sin
        F[S.EAST, S.HEADING], F[S.NORTH, S.HEADING] = east_by_heading, north_by_heading
        F[S.EAST, S.SPEED], F[S.NORTH, S.SPEED] = dt_s * sin, dt_s * cos
        F[S.HEADING, S.GYRO_BIAS], F[S.HEADING, S.GYRO_SCALE] = heading_by_bias, heading_by_scale
        for row, by_heading in ((S.EAST, east_by_heading), (S.NORTH, north_by_heading)):
            F[row, S.GYRO_BIAS] = 0.5 * by_heading * heading_by_bias
            F[row, S.GYRO_SCALE] = 0.5 * by_heading * heading_by_scale
        kept = math.exp(-dt_s / self._tuning.gps_error_time_s)
        F[S.GPS_EAST, S.GPS_EAST] = F[S.GPS_NORTH, S.GPS_NORTH] = kept
        step[S.GPS_EAST] = (kept - 1.0) * x[S.GPS_EAST]
        step[S.GPS_NORTH] = (kept - 1.0) * x[S.GPS_NORTH]
        self._set_noise(dt_s, gyro=turn_rad is not None, standing=standing)
        self.Q[S.GPS_EAST, S.GPS_EAST] = self.Q[S.GPS_NORTH, S.GPS_NORTH] = 1.0 - kept**2
        self.predict()

    def predict_x(self, u: float = 0.0) -> None:
        """Move the state by the step that `advance` worked out (filterpy calls this)."""
        del u
        self.x = self.x + self._step

    def _set_noise(self, dt_s: float, *, gyro: bool, standing: bool) -> None:
        tuning, Q = self._tuning, self.Q
        if standing:
            position_mps2, heading, acceleration = 0.0, 0.0, 0.05
        else:
            position_mps2 = tuning.position_noise_m_per_sqrt_s**2
            with_gyro = tuning.gyro_noise_deg_per_sqrt_s
            heading = math.radians(with_gyro if gyro else tuning.turn_noise_deg_per_sqrt_s)
            acceleration = tuning.acceleration_noise_mps_per_sqrt_s
        Q[S.EAST, S.EAST] = Q[S.NORTH, S.NORTH] = position_mps2 * dt_s
        Q[S.HEADING, S.HEADING] = heading**2 * dt_s
        Q[S.SPEED, S.SPEED] = acceleration**2 * dt_s
        bias = math.radians(tuning.gyro_bias_walk_degps_per_sqrt_s)
        Q[S.GYRO_BIAS, S.GYRO_BIAS] = bias**2 * dt_s
        Q[S.GYRO_SCALE, S.GYRO_SCALE] = tuning.gyro_scale_walk_per_sqrt_s**2 * dt_s
        Q[S.ODOMETER_SCALE, S.ODOMETER_SCALE] = tuning.odometer_scale_walk_per_sqrt_s**2 * dt_s

    def position(self, east_m: float, north_m: float, std_m: float) -> Measurement:
        """GPS position; of its variance a share varies slowly and is states of its own."""
        x, H, slow_std_m = self.x, self._jacobian(2), self._slow_std_m(std_m)
        H[0, S.EAST] = H[1, S.NORTH] = 1.0
        H[0, S.GPS_EAST] = H[1, S.GPS_NORTH] = slow_std_m
        error = slow_std_m * x[[S.GPS_EAST, S.GPS_NORTH]]
        hx = x[[S.EAST, S.NORTH]] + error
        R = np.eye(2) * (std_m**2 - slow_std_m**2)
        return Measurement("gps_position", np.array([east_m, north_m]), hx, H, R)

    def gps_speed(self, speed_mps: float, std_mps: float) -> Measurement:
        """GPS speed over ground, which has no sign."""
        direction = -1.0 if self.x[S.SPEED] < 0.0 else 1.0
        return self._scalar(
            "gps_speed", speed_mps, direction * self.x[S.SPEED], {S.SPEED: direction}, std_mps
        )

    def course(self, course_rad: float, std_rad: float) -> Measurement:
        """GPS course over ground: the heading, or its opposite in reverse."""
        heading = self.x[S.HEADING] + (math.pi if self.x[S.SPEED] < 0.0 else 0.0)
        scalar = self._scalar("gps_course", course_rad, heading, {S.HEADING: 1.0}, std_rad)
        return scalar._replace(angular=True)

    def odometer(self, speed_mps: float, std_mps: float) -> Measurement:
        """Wheel speed with sign; true speed = odometer_scale x measured."""
        speed, scale = self.x[S.SPEED], self.x[S.ODOMETER_SCALE]
        by_state = {S.SPEED: 1.0 / scale, S.ODOMETER_SCALE: -speed / scale**2}
        return self._scalar("odometer", speed_mps, speed / scale, by_state, std_mps)

    def still(self, std_mps: float) -> Measurement:
        """Zero velocity."""
        return self._scalar("standstill", 0.0, self.x[S.SPEED], {S.SPEED: 1.0}, std_mps)

    def still_rate(self, rate_radps: float, std_radps: float) -> Measurement:
        """What the gyro reads at standstill is its bias."""
        bias = self.x[S.GYRO_BIAS]
        return self._scalar("standstill_gyro", rate_radps, bias, {S.GYRO_BIAS: 1.0}, std_radps)

    def innovation(self, measurement: Measurement) -> tuple[Floats, float]:
        """Innovation and its normalised square (chi-square distributed when all is well)."""
        y = self._residual(measurement, measurement.z, measurement.hx)
        H = measurement.H
        S_ = H @ self.P @ H.T + measurement.R
        return y, float(y @ np.linalg.solve(S_, y))

    def correct(self, measurement: Measurement) -> None:
        """Update the state with a measurement that was linearised at it."""
        self.update(
            measurement.z,
            lambda _: measurement.H,
            lambda _: measurement.hx,
            R=measurement.R,
            residual=lambda z, hx: self._residual(measurement, z, hx),
        )
        self.x[S.HEADING] = wrap_pi(self.x[S.HEADING])

    def place(self, east_m: float, north_m: float, std_m: float) -> None:
        """Set the position to a fix, forgetting where it was (start, or after a lock-out)."""
        self.x, self.P = self.x.copy(), self.P.copy()
        for axis, error, value in (
            (S.EAST, S.GPS_EAST, east_m),
            (S.NORTH, S.GPS_NORTH, north_m),
        ):
            for state in (axis, error):
                self.P[state, :] = self.P[:, state] = 0.0
            self.x[axis], self.x[error] = value, 0.0
            self.P[axis, axis] = std_m**2
            self.P[error, error] = 1.0
            self.P[axis, error] = self.P[error, axis] = -self._slow_std_m(std_m)

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

    def std(self, state: States) -> float:
        """One sigma of a state."""
        return math.sqrt(max(self.P[state, state], 0.0))

    def _slow_std_m(self, std_m: float) -> float:
        return math.sqrt(self._tuning.gps_error_share) * std_m

    def _scalar(
        self, sensor: str, value: float, expected: float, by_state: dict[States, float], std: float
    ) -> Measurement:
        H = self._jacobian(1)
        for state, derivative in by_state.items():
            H[0, state] = derivative
        return Measurement(sensor, np.array([value]), np.array([expected]), H, np.array([[std**2]]))

    def _jacobian(self, rows: int) -> Floats:
        return np.zeros((rows, len(States)))

    @staticmethod
    def _residual(measurement: Measurement, z: Floats, hx: Floats) -> Floats:
        y: Floats = z - hx
        return np.array([wrap_pi(float(y[0]))]) if measurement.angular else y
