"""Pure: the filter that is told the simulation's noise: what is possible on a simulated drive.

An extended Kalman filter with the sensors' own error models at their true values. Nothing in it
is tuned, and it is told what befell the drive: where walls reflect, when wheels spun or locked,
which fixes an event moved. It never uses a fix of a later instant, but it is better off than a
filter on the road: fixes cost it no latency, it knows a standstill half a second ahead
(`motion.STANDING_S`), and between two wheel speeds it interpolates.
"""

import math
from typing import NamedTuple

import numpy as np

from wayline.messages import GpsFix
from wayline_evaluation.circumstances import Circumstances
from wayline_evaluation.dilution import ROUNDING, Dilution
from wayline_evaluation.estimates import Floats
from wayline_evaluation.gaussian import Gaussian, decayed, gate_of
from wayline_evaluation.motion import SensedMotion, changing_s, period_s
from wayline_evaluation.plane import Grid
from wayline_evaluation.sensed import Sensed
from wayline_evaluation.yardstick_state import (
    BIASES,
    WHEELS,
    YardstickStates,
    rounding_std_degps,
    start,
    start_stds,
    wheel_wander_std,
)
from wayline_simulator.gps_errors import ACROSS_SHARE, ALONG_SHARE
from wayline_simulator.gps_gaps import FORGETTING_S
from wayline_simulator.gps_measured import Effects
from wayline_simulator.gps_model import GpsModel
from wayline_simulator.gyro import GyroModel
from wayline_simulator.happenings import Happenings
from wayline_simulator.odometer import OdometerModel

GATE_PROBABILITY = 0.9999
"""A reflection or a displaced fix is no noise that can be told."""
HEADING_MPS = 2.0
"""From this speed on the first course sets the heading."""
COURSE_MPS = 1.0
"""Slower, a course is not made of the velocity alone."""
UNCHANGED_S = 1e6
"""At rest a gyro's rounding error stays as it is."""

S = YardstickStates
REFLECTED = [S.REFLECTED_EAST, S.REFLECTED_NORTH]


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
        self,
        gps: GpsModel,
        gyro: GyroModel,
        odometer: OdometerModel,
        happened: Happenings,
        sensed: Sensed,
    ) -> None:
        self.gps, self.gyro, self.odometer, self.happened = gps, gyro, odometer, happened
        self.heading_known = self._fixed = False
        self._fading_s = gps.first_error_time_s
        self._dilution = Dilution()
        self.state = Gaussian(start(gyro, odometer), start_stds(gps, gyro, odometer, happened))
        rounding_degps = gyro.resolution_degps / math.sqrt(12.0)
        shaken = rounding_degps**2 + gyro.vibration_degps**2
        self._turn_noise = gyro.noise_deg_per_sqrt_s**2 + shaken * period_s(sensed.yaw_rate_degps)
        self._turning_s = changing_s(sensed.yaw_rate_degps, gyro.resolution_degps)
        self._wheel_period_s = period_s(sensed.speed_mps)
        self._gate = gate_of(GATE_PROBABILITY, 2)

    @property
    def scale(self) -> float:
        """True distance over measured."""
        return float(self.state.mean[list(WHEELS)].sum())

    def speed(self, wheels_mps: float) -> tuple[float, float]:
        """Speed and its std where the wheels, signed, read so."""
        mean = self.state.mean
        row = np.zeros(len(S))
        row[list(WHEELS)], row[S.WHEEL_NOISE] = wheels_mps, 1.0
        variance = float(row @ self.state.covariance @ row)
        speed_mps = float(row @ mean)
        return speed_mps, math.sqrt(max(variance, 0.0))

    def advance(self, motion: SensedMotion, step: int, since_start_s: float) -> None:
        """From the instant before to that of `step`."""
        step_s = float(motion.times_s[step] - motion.times_s[step - 1])
        if step_s <= 0.0:
            return
        driven_m, turned_deg = float(motion.driven_m[step]), float(motion.turned_deg[step])
        leg = Leg(step_s, driven_m, turned_deg, self._warmth_k(since_start_s))
        mean, transition = self.state.mean.copy(), np.eye(len(S))
        noise = np.diag(self._wander(mean, transition, step_s, motion, step))
        noise[np.ix_(REFLECTED, REFLECTED)] *= self._across_and_along()
        standing = bool(motion.standing[step])
        if not standing:
            self._drive(mean, transition, noise, leg)
        self.state.advance(mean, transition, noise)
        if standing:
            self._stand(leg)

    def _drive(self, mean: Floats, transition: Floats, noise: Floats, leg: Leg) -> None:
        """Move and turn a mean; its derivatives go into the transition."""
        x, (step_s, driven_m, turned_deg, warmth_k) = self.state.mean, leg
        bias_degps = x[list(BIASES)].sum() + warmth_k * x[S.GYRO_WARMTH]
        turned_rad = math.radians(turned_deg - bias_degps * step_s)
        moved_m = self.scale * driven_m + x[S.WHEEL_NOISE] * step_s
        middle_rad = x[S.HEADING] + 0.5 * x[S.GYRO_SCALE] * turned_rad
        sin, cos = math.sin(middle_rad), math.cos(middle_rad)
        mean[S.EAST] += moved_m * sin
        mean[S.NORTH] += moved_m * cos
        mean[S.HEADING] += x[S.GYRO_SCALE] * turned_rad

        by_bias = -x[S.GYRO_SCALE] * math.radians(step_s)
        turn = dict.fromkeys(BIASES, by_bias) | {
            S.GYRO_WARMTH: by_bias * warmth_k,
            S.GYRO_SCALE: turned_rad,
        }
        move = dict.fromkeys(WHEELS, driven_m) | {S.WHEEL_NOISE: step_s}
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
        noise[S.HEADING, S.HEADING] = math.radians(1.0) ** 2 * self._turn_noise * step_s
        if not self.heading_known:
            noise[[S.EAST, S.NORTH], [S.EAST, S.NORTH]] = moved_m**2

    def _wander(
        self, mean: Floats, transition: Floats, step_s: float, motion: SensedMotion, step: int
    ) -> Floats:
        """Let the Gauss-Markov states decay; returns the process noise."""
        gps, gyro, odometer = self.gps, self.gyro, self.odometer
        slow = abs(float(motion.speeds_mps[step])) < odometer.dead_zone_mps
        white_mps = math.hypot(odometer.noise_mps, odometer.resolution_mps / math.sqrt(12.0))
        # a rounding error lasts as long as the reading does not change
        lasts_s = max(self._wheel_period_s, float(motion.steady_s[step]))
        places = [
            S.GYRO_WANDER, S.GYRO_ROUNDING, S.WHEEL_WANDER, S.WHEEL_SLIP, S.WHEEL_NOISE,
            S.GPS_EAST, S.GPS_NORTH, S.COLD_EAST, S.COLD_NORTH,
            S.REFLECTED_EAST, S.REFLECTED_NORTH,
        ]  # fmt: skip
        stds = np.array([
            gyro.bias_wander_std_degps, rounding_std_degps(gyro), wheel_wander_std(odometer),
            self.happened.slip_std,
            odometer.dead_zone_mps / math.sqrt(3.0) if slow else white_mps,
            gps.position_wander_std_m, gps.position_wander_std_m, 0.0, 0.0,
            1.0, 1.0,
        ])  # fmt: skip
        times_s = np.array([
            gyro.bias_wander_time_s, UNCHANGED_S if motion.standing[step] else self._turning_s,
            odometer.scale_wander_time_s, self.happened.slip_time_s,
            lasts_s / 2.0,
            gps.position_wander_time_s, gps.position_wander_time_s, self._fading_s, self._fading_s,
            gps.reflection_time_s, gps.reflection_time_s,
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
        row[0, list(BIASES)], row[0, S.GYRO_WARMTH] = 1.0, leg.warmth_k
        innovation = np.array([leg.turned_deg / leg.step_s]) - row @ self.state.mean
        self.state.correct(innovation, row, np.array([[self._turn_noise / leg.step_s]]))
        self.state.set(S.WHEEL_NOISE, 0.0, 0.0)

    def _warmth_k(self, since_start_s: float) -> float:
        return self.gyro.warm_up_kelvin * -math.expm1(-since_start_s / self.gyro.warm_up_time_s)

    def correct(self, fix: GpsFix, there: Circumstances, grid: Grid, wheels_mps: float) -> None:
        """Take in a fix at its own instant."""
        lats_deg, lons_deg = np.array([fix.lat_deg]), np.array([fix.lon_deg])
        east_m, north_m = (float(part[0]) for part in grid.to_grid(lats_deg, lons_deg))
        hdop = self._dilution.at(fix.hdop or 1.0, fix.t_ns * 1e-9)
        self._awake(there.blind_s)
        if not there.displaced:
            self._position(east_m, north_m, hdop, there.effects)
        if fix.speed_mps is None or fix.course_deg is None or fix.speed_mps < COURSE_MPS:
            return
        course_deg = fix.course_deg - float(grid.convergence_deg(lats_deg, lons_deg)[0])
        std_mps = self.gps.velocity_std_mps * hdop * there.effects.velocity
        self._velocity(fix.speed_mps, math.radians(course_deg), wheels_mps, std_mps)

    def _awake(self, blind_s: float) -> None:
        """After blindness a receiver's first fixes err by more, and fade."""
        std_m = 0.0
        if not self._fixed and self.gps.first_fix_s > 0.0:
            std_m = self.gps.first_error_m
        elif blind_s > 0.0:
            self._fading_s = self.gps.reacquire_error_time_s
            std_m = -math.expm1(-blind_s / FORGETTING_S) * self.gps.reacquire_error_m
        self._fixed = True
        if std_m > 0.0:
            for place in (S.COLD_EAST, S.COLD_NORTH):
                self.state.set(place, 0.0, std_m)

    def _position(self, east_m: float, north_m: float, hdop: float, effects: Effects) -> None:
        gps = self.gps
        rows = np.zeros((2, len(S)))
        rows[[0, 1], [S.EAST, S.NORTH]] = rows[[0, 1], [S.COLD_EAST, S.COLD_NORTH]] = 1.0
        rows[[0, 1], [S.GPS_EAST, S.GPS_NORTH]] = hdop
        rows[[0, 1], REFLECTED] = gps.reflection_std_m * effects.reflection
        white_m = math.hypot(
            gps.position_white_std_m * hdop * effects.position,
            gps.position_wander_std_m * ROUNDING,
        )
        measured, noise = np.array([east_m, north_m]), np.eye(2) * white_m**2
        if self.state.correct(measured - rows @ self.state.mean, rows, noise, self._gate):
            return
        # other walls reflect: nothing that was learned of the last ones holds
        for place in REFLECTED:
            self.state.set(place, 0.0, 0.0)
        self.state.covariance[np.ix_(REFLECTED, REFLECTED)] = self._across_and_along()
        self.state.correct(measured - rows @ self.state.mean, rows, noise, self._gate)

    def _across_and_along(self) -> Floats:
        """Covariance of new reflections, in shares: walls stand along the street."""
        if not self.heading_known:
            return 0.5 * np.eye(2)
        heading_rad = float(self.state.mean[S.HEADING])
        sin, cos = math.sin(heading_rad), math.cos(heading_rad)
        axes = np.array([[cos, sin], [-sin, cos]])
        turned: Floats = axes @ np.diag([ACROSS_SHARE**2, ALONG_SHARE**2]) @ axes.T
        return turned

    def _velocity(
        self, speed_mps: float, course_rad: float, wheels_mps: float, std_mps: float
    ) -> None:
        """Doppler: two axes with equal noise."""
        if not self.heading_known:
            if speed_mps >= HEADING_MPS:
                self._turn_to(course_rad, std_mps / speed_mps, wheels_mps)
            return
        heading_rad = self.state.mean[S.HEADING]
        own_mps, _ = self.speed(wheels_mps)
        sin, cos = math.sin(heading_rad), math.cos(heading_rad)
        rows = np.zeros((2, len(S)))
        for place, by in (*((wheel, wheels_mps) for wheel in WHEELS), (S.WHEEL_NOISE, 1.0)):
            rows[:, place] = by * sin, by * cos
        rows[:, S.HEADING] = own_mps * cos, -own_mps * sin
        measured = speed_mps * np.array([math.sin(course_rad), math.cos(course_rad)])
        noise = np.eye(2) * std_mps**2
        innovation = measured - own_mps * np.array([sin, cos])
        self.state.correct(innovation, rows, noise, self._gate)

    def _turn_to(self, course_rad: float, std_rad: float, wheels_mps: float) -> None:
        backwards_rad = math.pi if wheels_mps < 0.0 else 0.0
        self.state.set(S.HEADING, course_rad + backwards_rad, std_rad)
        self.heading_known = True
