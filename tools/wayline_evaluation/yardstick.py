"""Pure: the filter that is told the simulation's noise: what is possible on a simulated drive.

An extended Kalman filter with the sensors' own error models at their true values. Nothing in it
is tuned. It never uses a fix of a later instant, but it is better off than a filter on the road:
fixes cost it no latency, it knows a standstill half a second ahead (`motion.STANDING_S`), and
between two wheel speeds it interpolates.
"""

import math
from enum import IntEnum
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wayline.messages import GpsFix
from wayline_evaluation.dilution import ROUNDING, Dilution
from wayline_evaluation.estimates import Floats
from wayline_evaluation.gaussian import Gaussian, decayed, gate_of
from wayline_evaluation.motion import Motion, period_s
from wayline_evaluation.plane import Grid
from wayline_evaluation.sensed import Sensed
from wayline_simulator.gps_gaps import FORGETTING_S
from wayline_simulator.gps_model import GpsModel
from wayline_simulator.gyro import GyroModel
from wayline_simulator.odometer import OdometerModel

GATE_PROBABILITY = 0.9999
"""A reflection or a displaced fix is no noise that can be told."""
HEADING_MPS = 2.0
"""From this speed on the first course sets the heading."""
COURSE_MPS = 1.0
"""Slower, a course is not made of the velocity alone."""
UNKNOWN_M = 1e5


class States(IntEnum):
    """Places in the state, with the unit of each; the models say what each is."""

    EAST = 0  # m
    NORTH = 1  # m
    HEADING = 2  # rad, of the grid
    GYRO_BIAS = 3  # deg/s
    GYRO_WANDER = 4  # deg/s
    GYRO_WARMTH = 5  # deg/s per kelvin
    GYRO_SCALE = 6  # true over measured
    WHEEL_SCALE = 7  # true over measured
    WHEEL_WANDER = 8
    WHEEL_NOISE = 9  # m/s, to be added to the measured speed
    GPS_EAST = 10  # m at a HDOP of 1
    GPS_NORTH = 11
    COLD_EAST = 12  # m
    COLD_NORTH = 13


S = States


class Leg(NamedTuple):
    """What the sensors said of the way from one instant to the next."""

    step_s: float
    driven_m: float
    turned_deg: float
    warmth_k: float
    """What the gyro has warmed up by."""


class Yardstick:
    """One drive; advance and correct it in order of time."""

    def __init__(
        self, gps: GpsModel, gyro: GyroModel, odometer: OdometerModel, sensed: Sensed
    ) -> None:
        self.gps, self.gyro, self.odometer = gps, gyro, odometer
        self.heading_known = False
        self._fading_s = gps.first_error_time_s
        self._dilution = Dilution()
        self._fix_s: float | None = None
        self.state = Gaussian(_start(gyro, odometer), _start_stds(gps, gyro, odometer))
        rounding_degps = gyro.resolution_degps / math.sqrt(12.0)
        rounding = rounding_degps**2 * period_s(sensed.yaw_rate_degps)
        self._turn_noise = gyro.noise_deg_per_sqrt_s**2 + rounding
        self._wheel_period_s = period_s(sensed.speed_mps)
        self._gate = gate_of(GATE_PROBABILITY, 2)

    @property
    def scale(self) -> float:
        """True distance over measured."""
        return float(self.state.mean[S.WHEEL_SCALE] + self.state.mean[S.WHEEL_WANDER])

    def speed(self, wheels_mps: float) -> tuple[float, float]:
        """Speed and its std where the wheels, signed, read so."""
        mean = self.state.mean
        row = np.zeros(len(S))
        row[[S.WHEEL_SCALE, S.WHEEL_WANDER]], row[S.WHEEL_NOISE] = wheels_mps, 1.0
        variance = float(row @ self.state.covariance @ row)
        speed_mps = float(row @ mean)
        return speed_mps, math.sqrt(max(variance, 0.0))

    def advance(self, motion: Motion, step: int, since_start_s: float) -> None:
        """From the instant before to that of `step`."""
        step_s = float(motion.times_s[step] - motion.times_s[step - 1])
        if step_s <= 0.0:
            return
        driven_m, turned_deg = float(motion.driven_m[step]), float(motion.turned_deg[step])
        leg = Leg(step_s, driven_m, turned_deg, self._warmth_k(since_start_s))
        mean, transition = self.state.mean.copy(), np.eye(len(S))
        noise = self._wander(mean, transition, step_s, motion, step)
        standing = bool(motion.standing[step])
        if not standing:
            self._drive(mean, transition, noise, leg)
        self.state.advance(mean, transition, noise)
        if standing:
            self._stand(leg)

    def _drive(self, mean: Floats, transition: Floats, noise: Floats, leg: Leg) -> None:
        """Move and turn a mean; its derivatives go into the transition."""
        x, (step_s, driven_m, turned_deg, warmth_k) = self.state.mean, leg
        bias_degps = x[S.GYRO_BIAS] + x[S.GYRO_WANDER] + warmth_k * x[S.GYRO_WARMTH]
        turned_rad = math.radians(turned_deg - bias_degps * step_s)
        moved_m = (x[S.WHEEL_SCALE] + x[S.WHEEL_WANDER]) * driven_m + x[S.WHEEL_NOISE] * step_s
        middle_rad = x[S.HEADING] + 0.5 * x[S.GYRO_SCALE] * turned_rad
        sin, cos = math.sin(middle_rad), math.cos(middle_rad)
        mean[S.EAST] += moved_m * sin
        mean[S.NORTH] += moved_m * cos
        mean[S.HEADING] += x[S.GYRO_SCALE] * turned_rad

        by_bias = -x[S.GYRO_SCALE] * math.radians(step_s)
        turn = {
            S.GYRO_BIAS: by_bias,
            S.GYRO_WANDER: by_bias,
            S.GYRO_WARMTH: by_bias * warmth_k,
            S.GYRO_SCALE: turned_rad,
        }
        move = {S.WHEEL_SCALE: driven_m, S.WHEEL_WANDER: driven_m, S.WHEEL_NOISE: step_s}
        for place, by in turn.items():
            transition[S.HEADING, place] = by
            transition[S.EAST, place] = 0.5 * moved_m * cos * by
            transition[S.NORTH, place] = -0.5 * moved_m * sin * by
        for place, by in move.items():
            transition[S.EAST, place], transition[S.NORTH, place] = by * sin, by * cos
        transition[S.EAST, S.HEADING], transition[S.NORTH, S.HEADING] = (
            moved_m * cos,
            -moved_m * sin,
        )
        noise[S.HEADING] = math.radians(1.0) ** 2 * self._turn_noise * step_s
        if not self.heading_known:
            noise[[S.EAST, S.NORTH]] = moved_m**2

    def _wander(
        self, mean: Floats, transition: Floats, step_s: float, motion: Motion, step: int
    ) -> Floats:
        """Let the Gauss-Markov states decay; returns the process noise."""
        gps, gyro, odometer = self.gps, self.gyro, self.odometer
        slow = abs(float(motion.speeds_mps[step])) < odometer.dead_zone_mps
        white_mps = math.hypot(odometer.noise_mps, odometer.resolution_mps / math.sqrt(12.0))
        # a rounding error lasts as long as the reading does not change
        lasts_s = max(self._wheel_period_s, float(motion.steady_s[step]))
        places = [
            S.GYRO_WANDER, S.WHEEL_WANDER, S.WHEEL_NOISE,
            S.GPS_EAST, S.GPS_NORTH, S.COLD_EAST, S.COLD_NORTH,
        ]  # fmt: skip
        stds = np.array([
            gyro.bias_wander_std_degps, odometer.scale_wander_std,
            odometer.dead_zone_mps / math.sqrt(3.0) if slow else white_mps,
            gps.position_wander_std_m, gps.position_wander_std_m, 0.0, 0.0,
        ])  # fmt: skip
        times_s = np.array([
            gyro.bias_wander_time_s, odometer.scale_wander_time_s, lasts_s / 2.0,
            gps.position_wander_time_s, gps.position_wander_time_s, self._fading_s, self._fading_s,
        ])  # fmt: skip
        kept, new = decayed(stds, times_s, step_s)
        mean[places] *= kept
        transition[places, places] = kept
        noise = np.zeros(len(S))
        noise[places] = new
        return noise

    def _stand(self, leg: Leg) -> None:
        """The gyro reads its bias, the wheels err by nothing."""
        row = np.zeros((1, len(S)))
        row[0, [S.GYRO_BIAS, S.GYRO_WANDER, S.GYRO_WARMTH]] = 1.0, 1.0, leg.warmth_k
        innovation = np.array([leg.turned_deg / leg.step_s]) - row @ self.state.mean
        self.state.correct(innovation, row, np.array([[self._turn_noise / leg.step_s]]))
        self.state.set(S.WHEEL_NOISE, 0.0, 0.0)

    def _warmth_k(self, since_start_s: float) -> float:
        return self.gyro.warm_up_kelvin * -math.expm1(-since_start_s / self.gyro.warm_up_time_s)

    def correct(self, fix: GpsFix, grid: Grid, wheels_mps: float) -> None:
        """Take in a fix at its own instant."""
        lats_deg, lons_deg = np.array([fix.lat_deg]), np.array([fix.lon_deg])
        east_m, north_m = (float(part[0]) for part in grid.to_grid(lats_deg, lons_deg))
        hdop = self._dilution.at(fix.hdop or 1.0, fix.t_ns * 1e-9)
        self._awake(fix.t_ns * 1e-9)
        self._position(east_m, north_m, hdop)
        if fix.speed_mps is None or fix.course_deg is None or fix.speed_mps < COURSE_MPS:
            return
        course_deg = fix.course_deg - float(grid.convergence_deg(lats_deg, lons_deg)[0])
        self._velocity(fix.speed_mps, math.radians(course_deg), wheels_mps, hdop)

    def _awake(self, fix_s: float) -> None:
        """After blindness a receiver's first fixes err by more, and fade."""
        blind_s = 0.0 if self._fix_s is None else fix_s - self._fix_s
        self._fix_s = fix_s
        if blind_s > 1.5 / self.gps.rate_hz:
            self._fading_s = self.gps.reacquire_error_time_s
            std_m = -math.expm1(-blind_s / FORGETTING_S) * self.gps.reacquire_error_m
            for place in (S.COLD_EAST, S.COLD_NORTH):
                self.state.set(place, 0.0, std_m)

    def _position(self, east_m: float, north_m: float, hdop: float) -> None:
        rows = np.zeros((2, len(S)))
        rows[[0, 1], [S.EAST, S.NORTH]] = rows[[0, 1], [S.COLD_EAST, S.COLD_NORTH]] = 1.0
        rows[[0, 1], [S.GPS_EAST, S.GPS_NORTH]] = hdop
        innovation = np.array([east_m, north_m]) - rows @ self.state.mean
        white_m = math.hypot(
            self.gps.position_white_std_m * hdop, self.gps.position_wander_std_m * ROUNDING
        )
        noise = np.eye(2) * white_m**2
        self.state.correct(innovation, rows, noise, self._gate)

    def _velocity(
        self, speed_mps: float, course_rad: float, wheels_mps: float, hdop: float
    ) -> None:
        """Doppler: two axes with equal noise."""
        if not self.heading_known:
            if speed_mps >= HEADING_MPS:
                self._turn_to(course_rad, speed_mps, wheels_mps, hdop)
            return
        heading_rad = self.state.mean[S.HEADING]
        own_mps, _ = self.speed(wheels_mps)
        sin, cos = math.sin(heading_rad), math.cos(heading_rad)
        rows = np.zeros((2, len(S)))
        for place, by in (
            (S.WHEEL_SCALE, wheels_mps),
            (S.WHEEL_WANDER, wheels_mps),
            (S.WHEEL_NOISE, 1.0),
        ):
            rows[:, place] = by * sin, by * cos
        rows[:, S.HEADING] = own_mps * cos, -own_mps * sin
        measured = speed_mps * np.array([math.sin(course_rad), math.cos(course_rad)])
        noise = np.eye(2) * (self.gps.velocity_std_mps * hdop) ** 2
        innovation = measured - own_mps * np.array([sin, cos])
        self.state.correct(innovation, rows, noise, self._gate)

    def _turn_to(self, course_rad: float, speed_mps: float, wheels_mps: float, hdop: float) -> None:
        backwards_rad = math.pi if wheels_mps < 0.0 else 0.0
        std_rad = hdop * self.gps.velocity_std_mps / speed_mps
        self.state.set(S.HEADING, course_rad + backwards_rad, std_rad)
        self.heading_known = True


def _start(gyro: GyroModel, odometer: OdometerModel) -> Floats:
    mean = np.zeros(len(S))
    mean[S.GYRO_BIAS], mean[S.GYRO_SCALE] = gyro.bias_degps, 1.0
    mean[S.WHEEL_SCALE] = 1.0 / (1.0 + odometer.scale)
    return mean


def _start_stds(gps: GpsModel, gyro: GyroModel, odometer: OdometerModel) -> NDArray[np.float64]:
    stds = np.zeros(len(S))
    stds[[S.EAST, S.NORTH]], stds[S.HEADING] = UNKNOWN_M, math.pi
    stds[S.GYRO_BIAS], stds[S.GYRO_WANDER] = gyro.bias_std_degps, gyro.bias_wander_std_degps
    stds[S.GYRO_WARMTH], stds[S.GYRO_SCALE] = gyro.bias_per_kelvin_degps, gyro.scale_std
    stds[S.WHEEL_SCALE], stds[S.WHEEL_WANDER] = odometer.scale_std, odometer.scale_wander_std
    stds[[S.GPS_EAST, S.GPS_NORTH]] = gps.position_wander_std_m
    stds[[S.COLD_EAST, S.COLD_NORTH]] = gps.first_error_m
    return stds
