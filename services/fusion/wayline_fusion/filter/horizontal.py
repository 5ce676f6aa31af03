"""Pure: the horizontal filter of papers/001 on numpy arrays; filterpy does the Kalman algebra.

Frame: a local plane, east and north in metres; heading clockwise from north in radians.
The Gauss-Markov and random-walk models are those of papers/001, "Loose coupling"; the paper gives
no variances, ours and their reasons are in `wayline.tuning`. The acceleration is a first-order
Gauss-Markov process too (R. A. Singer, Estimating optimal tracking filter performance for manned
maneuvering targets, 1970).

What changes the covariance besides prediction and update has one of three names. `reset_` forgets
what a state had to do with the others, `inflate_` adds doubt and keeps that, `project_` moves a
shaping state on as time would. docs/fusion.md has the table of who may call which, and a test
holds the code to it.
"""

import math
from typing import NamedTuple

import numpy as np
from filterpy.kalman import KalmanFilter

from wayline.geo import wrap_pi
from wayline.likelihood import Measurement
from wayline.tuning import Tuning
from wayline_fusion.filter.states import SIZE, Floats, States

S = States

OF_MOTION = (S.EAST, S.NORTH, S.HEADING, S.WHEEL_SPEED, S.ACCELERATION, S.GPS_EAST, S.GPS_NORTH)
"""All but the sensors' calibration."""
OF_PLACE = (S.EAST, S.NORTH)
OF_FIX = (*OF_PLACE, S.GPS_EAST, S.GPS_NORTH)
OF_RECKONING = (S.EAST, S.NORTH, S.HEADING, S.GYRO_BIAS)
SPEED_UNKNOWN_MPS = 40.0
"""Std of a speed that may be any."""
SCALE_UNKNOWN = 0.2
"""Of other tyres, or of a speed in a unit that was guessed."""
SURE_HEADING_RAD2 = math.radians(6.0) ** 2
"""Where a heading is as sure, what is across it is a hundredth of what is along it."""
TURNING_RADIUS_M = 6.0
"""Of a car's tightest turn."""
STANDING_MPS_PER_SQRT_S = 0.05
"""What is left to the speed of a vehicle that stands."""


class DrivingNoise(NamedTuple):
    """What is known of this gyro beyond the configuration."""

    turn_rad_per_sqrt_s: float
    bias_walk: float
    """Of the gyro bias, rad/s per root s."""
    fix_error_time_s: float
    """For so long fixes are wrong alike."""


class HorizontalFilter(KalmanFilter):  # type: ignore[misc]
    """Extended Kalman filter over `States`: filterpy's, given what is linearised here."""

    def __init__(self, tuning: Tuning, size: int = SIZE) -> None:
        super().__init__(dim_x=size, dim_z=2)
        self._tuning = tuning
        self.x = np.zeros(size)
        self.x[S.GYRO_SCALE] = self.x[S.ODOMETER_SCALE] = 1.0
        self.P = np.diag(np.square(self._initial_stds()))
        self.F = np.eye(size)
        self.Q = np.zeros((size, size))
        self.inv = _inverse

    def _initial_stds(self) -> list[float]:
        tuning = self._tuning
        return [
            1e4,
            1e4,
            math.pi,
            SPEED_UNKNOWN_MPS,
            math.radians(tuning.gyro_bias_initial_std_degps),
            tuning.gyro_scale_initial_std,
            tuning.odometer_scale_initial_std,
            1.0,
            1.0,
            tuning.gps_latency_std_s,
            tuning.acceleration_std_mps2,
            math.radians(tuning.course_bias_std_deg),
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
        heading, bias, scale = x[S.HEADING], x[S.GYRO_BIAS], x[S.GYRO_SCALE]
        wheels, odometer_scale = x[S.WHEEL_SPEED], x[S.ODOMETER_SCALE]
        measured = turn_rad is not None and not standing
        turned = 0.0 if turn_rad is None or standing else turn_rad - bias * dt_s
        middle = heading + 0.5 * scale * turned
        sin, cos = math.sin(middle), math.cos(middle)
        lasting = 0.0 if standing else math.exp(-dt_s / self._tuning.acceleration_time_s)
        # what an acceleration of 1 makes of the speed
        gain_s = 0.0 if standing else self._tuning.acceleration_time_s * (1.0 - lasting)
        later = _braked(wheels, x[S.ACCELERATION], gain_s, lasting)
        rolled = 0.5 * (wheels + later[0]) * dt_s
        moved = odometer_scale * rolled

        heading_by_bias = -scale * dt_s if measured else 0.0
        heading_by_scale = turned if measured else 0.0
        east_by_heading, north_by_heading = moved * cos, -moved * sin
        F[S.EAST, S.HEADING], F[S.NORTH, S.HEADING] = east_by_heading, north_by_heading
        by_wheels, by_acceleration = odometer_scale * dt_s, 0.5 * odometer_scale * gain_s * dt_s
        F[S.EAST, S.WHEEL_SPEED], F[S.NORTH, S.WHEEL_SPEED] = by_wheels * sin, by_wheels * cos
        F[S.EAST, S.ODOMETER_SCALE], F[S.NORTH, S.ODOMETER_SCALE] = rolled * sin, rolled * cos
        F[S.HEADING, S.GYRO_BIAS], F[S.HEADING, S.GYRO_SCALE] = heading_by_bias, heading_by_scale
        F[S.EAST, S.GYRO_BIAS] = 0.5 * east_by_heading * heading_by_bias
        F[S.EAST, S.GYRO_SCALE] = 0.5 * east_by_heading * heading_by_scale
        F[S.NORTH, S.GYRO_BIAS] = 0.5 * north_by_heading * heading_by_bias
        F[S.NORTH, S.GYRO_SCALE] = 0.5 * north_by_heading * heading_by_scale
        F[S.EAST, S.ACCELERATION] = by_acceleration * sin
        F[S.NORTH, S.ACCELERATION] = by_acceleration * cos
        F[S.WHEEL_SPEED, S.ACCELERATION], F[S.ACCELERATION, S.ACCELERATION] = gain_s, lasting
        kept = math.exp(-dt_s / noise.fix_error_time_s)
        F[S.GPS_EAST, S.GPS_EAST] = F[S.GPS_NORTH, S.GPS_NORTH] = kept
        self.Q[S.GPS_EAST, S.GPS_EAST] = self.Q[S.GPS_NORTH, S.GPS_NORTH] = 1.0 - kept**2
        self._set_noise(dt_s, noise, gyro=turn_rad is not None, standing=standing)
        self._set_acceleration_noise(dt_s, lasting, standing=standing)
        before_m2 = self._position_m2()
        self.predict()
        self._turn_growth(self._position_m2() - before_m2)
        # the state itself moves by the model, not by its linearisation
        x[S.EAST] += moved * sin
        x[S.NORTH] += moved * cos
        x[S.HEADING] += scale * turned
        x[S.WHEEL_SPEED], x[S.ACCELERATION] = later
        x[S.GPS_EAST] *= kept
        x[S.GPS_NORTH] *= kept
        self.x = np.array(x)

    def _position_m2(self) -> float:
        """Variance of the position, both axes."""
        variance: float = self.P.item(S.EAST, S.EAST) + self.P.item(S.NORTH, S.NORTH)
        return variance

    def _turn_growth(self, grown_m2: float) -> None:
        """What doubt of the speed has added to the position may lie across an unsure heading.

        A linear model has it along the heading alone: from rest it would be sure to go straight on.
        This is the second-order term, E[sin^2] of a normally distributed angle.
        """
        heading_rad2 = self.P.item(S.HEADING, S.HEADING)
        if heading_rad2 < SURE_HEADING_RAD2 or grown_m2 <= 0.0:
            return
        across_m2 = 0.5 * (1.0 - math.exp(-2.0 * heading_rad2)) * grown_m2
        self.P[S.EAST, S.EAST] += across_m2
        self.P[S.NORTH, S.NORTH] += across_m2

    def _set_noise(self, dt_s: float, noise: DrivingNoise, *, gyro: bool, standing: bool) -> None:
        # a view of the diagonal, made anew: a copy of the filter would keep a view of the old Q
        tuning, variances = self._tuning, self.Q.reshape(-1)[:: len(self.Q) + 1]
        if standing:
            position_mps2, heading = 0.0, 0.0
        else:
            position_mps2 = tuning.position_noise_m_per_sqrt_s**2
            heading = noise.turn_rad_per_sqrt_s if gyro else self.turn_rad_per_sqrt_s()
        variances[S.EAST] = variances[S.NORTH] = position_mps2 * dt_s
        variances[S.HEADING] = heading**2 * dt_s
        variances[S.GYRO_BIAS] = noise.bias_walk**2 * dt_s
        variances[S.GYRO_SCALE] = tuning.gyro_scale_walk_per_sqrt_s**2 * dt_s
        variances[S.ODOMETER_SCALE] = tuning.odometer_scale_walk_per_sqrt_s**2 * dt_s

    def turn_rad_per_sqrt_s(self) -> float:
        """Without a gyro: what steering and the way allow, and at speed what passengers bear."""
        tuning, fastest_mps = self._tuning, max(abs(self.speed_mps) + self.speed_std_mps, 0.1)
        slow = min(math.radians(tuning.turn_noise_deg_per_sqrt_s), fastest_mps / TURNING_RADIUS_M)
        return min(slow, tuning.lateral_acceleration_std_mps2 / fastest_mps)

    def _set_acceleration_noise(self, dt_s: float, lasting: float, *, standing: bool) -> None:
        """Of the acceleration, and of the speed that it makes."""
        Q, tuning = self.Q, self._tuning
        variance = tuning.acceleration_std_mps2**2
        density = 0.0 if standing else 2.0 * variance / tuning.acceleration_time_s
        rest_mps2 = STANDING_MPS_PER_SQRT_S**2 if standing else 0.0
        Q[S.WHEEL_SPEED, S.WHEEL_SPEED] = (density * dt_s**2 / 3.0 + rest_mps2) * dt_s
        Q[S.WHEEL_SPEED, S.ACCELERATION] = Q[S.ACCELERATION, S.WHEEL_SPEED] = (
            0.5 * density * dt_s**2
        )
        Q[S.ACCELERATION, S.ACCELERATION] = variance * (1.0 - lasting**2)

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

    def consider(self, measurement: Measurement, state: int) -> None:
        """Update all but one state, whose doubt is counted all the same.

        This is the Schmidt-Kalman update: the optimal one, but that the state and its variance
        stay.
        """
        value, variance = self.x[state], self.P[state, state]
        self.correct(measurement)
        self.x[state], self.P[state, state] = value, variance

    def reset_position(
        self, east_m: float, north_m: float, std_m: float, doubt_m: float = 0.0
    ) -> None:
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

    def project_fix_error(self, kept: float) -> None:
        """Let only a part of the fixes' slow error go on, and a new one come, as time would."""
        self.x, self.P = self.x.copy(), self.P.copy()
        for error in (S.GPS_EAST, S.GPS_NORTH):
            self.x[error] *= kept
            self.P[error, :] *= kept
            self.P[:, error] *= kept
            self.P[error, error] += 1.0 - kept**2

    def reset_heading(self, heading_rad: float, std_rad: float) -> None:
        """Set the heading, forgetting what it was."""
        self._reset_value(S.HEADING, wrap_pi(heading_rad), std_rad)

    def reset_reckoning(
        self, values: tuple[float, float, float, float], covariance: Floats
    ) -> None:
        """Set east, north, heading and gyro bias, forgetting what they were."""
        self.x, self.P = self.x.copy(), self.P.copy()
        for state, value in zip(OF_RECKONING, values, strict=True):
            self.x[state] = value
            self.P[state, :] = self.P[:, state] = 0.0
        self.x[S.HEADING] = wrap_pi(self.x.item(S.HEADING))
        self.P[np.ix_(OF_RECKONING, OF_RECKONING)] = covariance

    def reset_motion(self) -> None:
        """Forget position, heading, speed and the fixes' error; keep the sensors' calibration."""
        self.x, self.P = self.x.copy(), self.P.copy()
        initial = np.square(self._initial_stds())
        for state in OF_MOTION:
            self.x[state] = 0.0
            self.P[state, :] = self.P[:, state] = 0.0
            self.P[state, state] = initial[state]

    def reset_speed(self) -> None:
        """Forget the speed: noise has made it negative, and no wheel has said reverse."""
        self._reset_value(S.WHEEL_SPEED, 0.0, self._tuning.acceleration_noise_mps_per_sqrt_s)

    def mirror(self) -> None:
        """Turn the heading round and change the speed's sign: the same motion, told forwards."""
        sign = np.ones(len(self.x))
        sign[[S.WHEEL_SPEED, S.ACCELERATION]] = -1.0
        self.x = sign * self.x
        self.x[S.HEADING] = wrap_pi(float(self.x[S.HEADING]) + math.pi)
        self.P = self.P * np.outer(sign, sign)

    def reset_wheel_speed(self, speed_mps: float, std_mps: float, *, is_over_ground: bool) -> None:
        """Set the wheel speed; one that was measured over ground is off by the wheels' scale."""
        self.x, self.P = self.x.copy(), self.P.copy()
        shared = -speed_mps * self.P[S.ODOMETER_SCALE] if is_over_ground else 0.0
        self.x[S.WHEEL_SPEED] = speed_mps
        self.P[S.WHEEL_SPEED, :] = self.P[:, S.WHEEL_SPEED] = shared
        scale_mps = speed_mps * self.std(S.ODOMETER_SCALE) if is_over_ground else 0.0
        self.P[S.WHEEL_SPEED, S.WHEEL_SPEED] = std_mps**2 + scale_mps**2

    def inflate_acceleration(self, gained_mps: float, over_s: float) -> None:
        """Doubt the acceleration: the vehicle may have gained or lost so much at an even rate."""
        heading_rad = float(self.x[S.HEADING])
        made = np.zeros(len(self.x))
        made[S.ACCELERATION], made[S.WHEEL_SPEED] = gained_mps / over_s, gained_mps
        made[S.EAST] = 0.5 * over_s * gained_mps * math.sin(heading_rad)
        made[S.NORTH] = 0.5 * over_s * gained_mps * math.cos(heading_rad)
        self.P = self.P + np.outer(made, made)

    def reset_scale(self, wheels_mps: float, std: float) -> None:
        """Set the odometer's scale to what makes the speed of a wheel speed that comes next."""
        self._reset_value(S.ODOMETER_SCALE, abs(self.speed_mps / wheels_mps), std)

    def _reset_value(self, state: int, value: float, std: float) -> None:
        self.reset_std(state, std)
        self.x = self.x.copy()
        self.x[state] = value

    def reset_std(self, state: int, std: float) -> None:
        """Keep a state's value, trust it so much, and forget what it has to do with others."""
        self.P = self.P.copy()
        self.P[state, :] = self.P[:, state] = 0.0
        self.P[state, state] = std**2

    def inflate_std(self, state: int, std: float) -> None:
        """Doubt one state by so much more, and keep what it has to do with others."""
        self.P = self.P.copy()
        self.P[state, state] += std**2

    def inflate_position(self, std_m: float) -> None:
        """Doubt the position: dead reckoning has gone astray by about so much."""
        self.inflate_std(S.EAST, std_m)
        self.inflate_std(S.NORTH, std_m)

    def reset_way(self) -> None:
        """Forget what the position has to do with how the vehicle has come there; keep its std.

        Over a way in directions that are not known, a wrong heading bends it and a wrong speed
        stretches it by more than their derivatives say.
        """
        self.P = self.P.copy()
        for state in OF_PLACE:
            variance = self.P[state, state]
            self.P[state, :] = self.P[:, state] = 0.0
            self.P[state, state] = variance

    def reset_place(self, east_m: float, north_m: float, covariance: Floats) -> None:
        """Set the position, forgetting how the vehicle came there.

        The covariance is that of `OF_FIX`: the fixes' slow error is what the position shares.
        """
        self.x, self.P = self.x.copy(), self.P.copy()
        self.x[S.EAST], self.x[S.NORTH] = east_m, north_m
        self.P[OF_FIX, :] = self.P[:, OF_FIX] = 0.0
        self.P[np.ix_(OF_FIX, OF_FIX)] = covariance

    def inflate_turn(self, turned_rad: float, over_s: float) -> None:
        """Doubt the heading: the vehicle may have turned so far at an even rate."""
        heading_rad, way_m = float(self.x[S.HEADING]), abs(self.speed_mps) * over_s
        made = np.zeros(len(self.x))
        made[S.HEADING] = turned_rad
        made[S.EAST] = 0.5 * way_m * turned_rad * math.cos(heading_rad)
        made[S.NORTH] = -0.5 * way_m * turned_rad * math.sin(heading_rad)
        self.P = self.P + np.outer(made, made)

    def inflate_arc(self, turned_rad: float, over_s: float) -> None:
        """Doubt the position: an even turn has made an arc of a way that was reckoned straight.

        An arc is shorter than its tangent: sin(a) / a = 1 - a^2 / 6 + ...
        """
        way_m = abs(self.speed_mps) * over_s
        self.inflate_position(way_m * min(turned_rad**2 / 6.0, 1.0))

    def recentre(self, turn_rad: float) -> None:
        """Move the plane's origin under the vehicle; headings gain `turn_rad` in the new plane."""
        self.x = self.x.copy()
        self.x[S.EAST] = self.x[S.NORTH] = 0.0
        self.x[S.HEADING] += turn_rad

    @property
    def speed_mps(self) -> float:
        """Over ground, negative in reverse."""
        # plain numbers: numpy's own are slow to calculate with
        x = self.x
        speed_mps: float = x.item(S.ODOMETER_SCALE) * x.item(S.WHEEL_SPEED)
        return speed_mps

    @property
    def speed_std_mps(self) -> float:
        """One sigma of the speed, by its derivatives."""
        by_wheels, by_scale = self.x.item(S.ODOMETER_SCALE), self.x.item(S.WHEEL_SPEED)
        covariance = self.P.item
        variance = (
            by_wheels**2 * covariance(S.WHEEL_SPEED, S.WHEEL_SPEED)
            + by_scale**2 * covariance(S.ODOMETER_SCALE, S.ODOMETER_SCALE)
            + 2.0 * by_wheels * by_scale * covariance(S.WHEEL_SPEED, S.ODOMETER_SCALE)
        )
        return math.sqrt(max(variance, 0.0))

    def std(self, state: int) -> float:
        """One sigma of a state."""
        variance: float = self.P.item(state, state)
        return 0.0 if variance < 0.0 else math.sqrt(variance)

    def slow_std_m(self, std_m: float) -> float:
        """The part of a fix's std that varies slowly."""
        return math.sqrt(self._tuning.gps_error_share) * std_m


def _braked(
    speed_mps: float, acceleration_mps2: float, gain_s: float, lasting: float
) -> tuple[float, float]:
    """Speed and acceleration after a step; who brakes comes to rest, and does not turn round."""
    after_mps = speed_mps + gain_s * acceleration_mps2
    if speed_mps * after_mps < 0.0:
        return 0.0, 0.0
    return after_mps, lasting * acceleration_mps2


def _inverse(S: Floats) -> np.ndarray:
    """Of an innovation's covariance, which is mostly a single number."""
    return 1.0 / S if len(S) == 1 else np.linalg.inv(S)
