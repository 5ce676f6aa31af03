"""Pure: the yardstick's altitude and grade: a Kalman filter that is told its sensors' noise.

It knows the day's air, what tunnels do to the pressure and the road's unrest too. What the
engine's torque tells of the grade it does not know.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from enum import IntEnum
from heapq import merge
from typing import NamedTuple

import numpy as np

from wayline.air import EXPONENT, SCALE_M
from wayline.messages import GpsFix
from wayline_evaluation.circumstances import Circumstances
from wayline_evaluation.dilution import ROUNDING, Dilution
from wayline_evaluation.estimates import Estimates, Floats
from wayline_evaluation.gaussian import Gaussian, decayed, gate_of
from wayline_evaluation.reference import Reference
from wayline_evaluation.sensed import Sensed
from wayline_evaluation.tunnel_air import piston_pa
from wayline_simulator.barometer import (
    GAS_CONSTANT,
    KELVIN,
    LAPSE_KELVIN_PER_M,
    STANDARD_KELVIN,
    BarometerModel,
)
from wayline_simulator.facts import Facts
from wayline_simulator.gps_gaps import FORGETTING_S
from wayline_simulator.gps_measured import ALTITUDE_FACTOR, Effects
from wayline_simulator.gps_model import GpsModel
from wayline_simulator.weather import Weather

GATE = gate_of(0.9999, 1)
UNREST_M = 100.0
"""Grade is taken to walk as far in this length as the road's really does; a filter smooths over
about as much."""
FIRST_GRADE_STD = 0.05
UNKNOWN_M = 1e4
VDOP_FACTOR = 1.5
"""Of HDOP, where a receiver tells that alone."""
GPS_ROUNDING_M = 0.1 / np.sqrt(12.0)
"""GGA tells decimetres."""


class AltitudeStates(IntEnum):
    """Places in the state."""

    ALTITUDE = 0  # m
    GRADE = 1  # tangent
    BARO_OFFSET = 2  # Pa
    BARO_WANDER = 3  # Pa
    FAN = 4  # Pa
    GPS_WANDER = 5  # m at a VDOP of 1
    COLD = 6  # m
    TOLD = 7  # m, the altitude that the receiver smooths
    REFLECTED = 8  # share of what a canyon's walls do


S = AltitudeStates


class Event(NamedTuple):
    """A pose that is due, or a measurement."""

    time_s: float
    kind: int
    """0 fix, 1 pressure, 2 pose."""
    place: int


def road_unrest_pct2_per_m(truth: Reference) -> float:
    """How fast the square of a road's change of grade grows with distance, over `UNREST_M`."""
    even_m = np.arange(0.0, truth.distances_m[-1], UNREST_M)
    moved = np.diff(truth.distances_m, prepend=-1.0) > 0.0
    grades_pct = np.interp(even_m, truth.distances_m[moved], truth.grades_pct[moved])
    return float(np.mean(np.square(np.diff(grades_pct)))) / UNREST_M if len(even_m) > 1 else 0.0


def told_altitudes(
    flat: Estimates,
    sensed: Sensed,
    facts: Facts,
    there: Sequence[Circumstances],
    *,
    fixes_early_s: float,
    grade_walk_pct2_per_m: float,
) -> Estimates:
    """The estimates with altitude and grade; `flat` holds the horizontal ones."""
    if facts.gps is None:
        return flat
    filter_ = AltitudeYardstick(
        facts.gps, facts.barometer, facts.weather, grade_walk_pct2_per_m * 1e-4
    )
    rows = np.full((len(flat.times_s), 4), np.nan)
    backwards = np.sign(np.nan_to_num(flat.speeds_mps))
    steps_m = np.diff(np.nan_to_num(flat.distances_m), prepend=0.0) * np.where(backwards < 0, -1, 1)
    path_m = np.cumsum(steps_m)
    speeds_mps = np.interp(sensed.pressure_pa.times_s, flat.times_s, np.nan_to_num(flat.speeds_mps))
    air_pa = sensed.pressure_pa.values - piston_pa(
        sensed.pressure_pa.times_s,
        speeds_mps,
        facts.happenings,
        facts.barometer or BarometerModel(),
    )
    now_s, now_m = float(flat.times_s[0]), float(path_m[0])
    for event in _events(flat.times_s, sensed, fixes_early_s):
        place_m = float(np.interp(event.time_s, flat.times_s, path_m))
        filter_.advance(event.time_s - now_s, place_m - now_m)
        now_s, now_m = event.time_s, place_m
        if event.kind == 0:
            filter_.fix(sensed.fixes[event.place], there[event.place], now_s)
        elif event.kind == 1:
            speed_mps = float(speeds_mps[event.place])
            filter_.pressure(float(air_pa[event.place]), speed_mps, now_s - sensed.start_s)
        elif filter_.known:
            rows[event.place] = filter_.row()
    return replace(
        flat,
        alts_m=rows[:, 0],
        grades_pct=100.0 * rows[:, 1],
        alt_stds_m=rows[:, 2],
        grade_stds_pct=100.0 * rows[:, 3],
    )


def _events(poses_s: Floats, sensed: Sensed, fixes_early_s: float) -> Iterator[Event]:
    fixes = [Event(f.t_ns * 1e-9 + fixes_early_s, 0, i) for i, f in enumerate(sensed.fixes)]
    pressures = [Event(float(t), 1, i) for i, t in enumerate(sensed.pressure_pa.times_s)]
    poses = [Event(float(t), 2, i) for i, t in enumerate(poses_s)]
    return merge(fixes, pressures, poses)


class AltitudeYardstick:
    """One drive; advance and correct it in order of time."""

    def __init__(
        self,
        gps: GpsModel,
        barometer: BarometerModel | None,
        weather: Weather,
        grade_walk_per_m: float,
    ) -> None:
        self.known = self._fixed = False
        self._gps, self._barometer, self._weather = gps, barometer, weather
        self._grade_walk_per_m = grade_walk_per_m
        self._fading_s = gps.first_error_time_s
        self._altitude_s: float | None = None
        self._dilution = Dilution()
        self._last_pa, self._same = 0.0, 0
        self._start_alt_m = 0.0
        self.state = Gaussian(np.zeros(len(S)), _start_stds(gps, barometer))

    def row(self) -> tuple[float, float, float, float]:
        """Altitude and grade (a tangent), then their stds."""
        mean, variances = self.state.mean, np.diagonal(self.state.covariance)
        alt_std_m, grade_std = np.sqrt(variances[[S.ALTITUDE, S.GRADE]])
        return float(mean[S.ALTITUDE]), float(mean[S.GRADE]), float(alt_std_m), float(grade_std)

    def advance(self, step_s: float, moved_m: float) -> None:
        """Drive on; `moved_m` is negative in reverse."""
        if step_s <= 0.0:
            return
        gps, barometer = self._gps, self._barometer or BarometerModel()
        places = [S.BARO_WANDER, S.FAN, S.GPS_WANDER, S.COLD, S.REFLECTED]
        stds = [barometer.wander_std_pa, barometer.fan_step_pa, gps.altitude_wander_std_m, 0.0, 1.0]
        times_s = [
            barometer.wander_time_s,
            barometer.fan_every_s,
            gps.altitude_wander_time_s,
            self._fading_s,
            gps.reflection_time_s,
        ]
        kept, new = decayed(np.array(stds), np.array(times_s), step_s)
        mean, transition, noise = self.state.mean.copy(), np.eye(len(S)), np.zeros(len(S))
        mean[places] *= kept
        transition[places, places] = kept
        noise[places] = new
        mean[S.ALTITUDE] += moved_m * mean[S.GRADE]
        transition[S.ALTITUDE, S.GRADE] = moved_m
        noise[S.GRADE] = self._grade_walk_per_m * abs(moved_m)
        self.state.advance(mean, transition, np.diag(noise))

    def fix(self, fix: GpsFix, there: Circumstances, time_s: float) -> None:
        """Take in the altitude of a 3-D fix, which the receiver may have smoothed."""
        if not self._fixed and self._gps.first_fix_s > 0.0:
            self.state.set(S.COLD, 0.0, ALTITUDE_FACTOR * self._gps.first_error_m)
        elif there.blind_s > 0.0:
            self._fading_s = self._gps.reacquire_error_time_s
            severity = -math.expm1(-there.blind_s / FORGETTING_S)
            self.state.set(S.COLD, 0.0, ALTITUDE_FACTOR * severity * self._gps.reacquire_error_m)
        self._fixed = True
        if fix.alt_m is None or fix.mode == 2:
            return
        longest_s = 1.5 / self._gps.rate_hz
        first = self._altitude_s is None or time_s - self._altitude_s > longest_s
        self._altitude_s = time_s
        vdop = fix.vdop or VDOP_FACTOR * (fix.hdop or 1.0)
        before, vdop = self.state.copy(), self._dilution.at(vdop, time_s)
        self._smooth(vdop, there.effects, first=first)
        if not self._told(fix.alt_m):
            # other walls reflect: nothing that was learned of the last ones holds
            self.state = before
            self.state.set(S.REFLECTED, 0.0, 1.0)
            self._smooth(vdop, there.effects, first=first)
            self._told(fix.alt_m)
        if not self.known:
            self.known, self._start_alt_m = True, fix.alt_m

    def _told(self, alt_m: float) -> bool:
        row = np.zeros((1, len(S)))
        row[0, S.TOLD] = 1.0
        innovation = np.array([alt_m - self.state.mean[S.TOLD]])
        return self.state.correct(innovation, row, np.array([[GPS_ROUNDING_M**2]]), GATE)

    def _smooth(self, vdop: float, effects: Effects, *, first: bool) -> None:
        """The receiver's lag: what it tells is the old value and the new one."""
        time_s = self._gps.smoothing_time_s
        old = 0.0 if first or time_s <= 0.0 else float(np.exp(-1.0 / (self._gps.rate_hz * time_s)))
        transition, noise = np.eye(len(S)), np.zeros(len(S))
        reflection_m = self._gps.reflection_std_m * effects.reflection
        transition[S.TOLD, [S.ALTITUDE, S.GPS_WANDER, S.COLD, S.REFLECTED]] = (
            1.0 - old
        ) * np.array([1.0, vdop, 1.0, reflection_m])
        transition[S.TOLD, S.TOLD] = old
        white_m = math.hypot(
            vdop * effects.position * self._gps.altitude_white_std_m,
            ROUNDING * self._gps.altitude_wander_std_m,
        )
        noise[S.TOLD] = ((1.0 - old) * white_m) ** 2
        self.state.advance(transition @ self.state.mean, transition, np.diag(noise))

    def pressure(self, pressure_pa: float, speed_mps: float, since_start_s: float) -> None:
        """Take in a pressure."""
        if self._barometer is None or not self.known:
            return
        self._same = self._same + 1 if pressure_pa == self._last_pa else 1
        self._last_pa = pressure_pa
        weather = self._weather
        air_pa = pressure_pa - weather.pressure_trend_pa_per_h * since_start_s / 3600.0
        flow_pa = _dynamic_pa(air_pa, speed_mps, weather)
        air_pa -= self._barometer.airflow_coefficient * flow_pa
        altitude_m, metres_per_pa = _altitude_m(air_pa, self._start_alt_m, weather)
        row = np.zeros((1, len(S)))
        row[0, S.ALTITUDE] = 1.0
        row[0, [S.BARO_OFFSET, S.BARO_WANDER, S.FAN]] = -metres_per_pa
        white_pa = math.hypot(self._barometer.noise_pa, self._barometer.buffeting_share * flow_pa)
        # a rounding error stays while the reading does: equal readings tell it once
        rounding_pa2 = self._barometer.resolution_pa**2 / 12.0 * self._same
        noise = np.array([[metres_per_pa**2 * (white_pa**2 + rounding_pa2)]])
        measured_m = np.array([altitude_m])
        if not self.state.correct(measured_m - row @ self.state.mean, row, noise, GATE):
            # the fan has changed its stage
            self.state.set(S.FAN, 0.0, self._barometer.fan_step_pa)
            self.state.correct(measured_m - row @ self.state.mean, row, noise, GATE)


def _altitude_m(air_pa: float, start_alt_m: float, weather: Weather) -> tuple[float, float]:
    """Altitude in the day's air, and metres lost for each pascal gained."""
    kelvin = KELVIN + weather.temperature_c + LAPSE_KELVIN_PER_M * start_alt_m
    scale_m = SCALE_M * kelvin / STANDARD_KELVIN
    share = (air_pa / weather.sea_level_pa) ** EXPONENT
    return scale_m * (1.0 - share), scale_m * EXPONENT * share / air_pa


def _dynamic_pa(air_pa: float, speed_mps: float, weather: Weather) -> float:
    """Of driving and the wind; head and tail wind cancel over a day's roads."""
    density_kg_per_m3 = air_pa / (GAS_CONSTANT * (KELVIN + weather.temperature_c))
    return 0.5 * density_kg_per_m3 * (speed_mps**2 + weather.wind_mps**2)


def _start_stds(gps: GpsModel, barometer: BarometerModel | None) -> Floats:
    stds = np.zeros(len(S))
    stds[S.ALTITUDE], stds[S.GRADE], stds[S.REFLECTED] = UNKNOWN_M, FIRST_GRADE_STD, 1.0
    stds[S.GPS_WANDER] = gps.altitude_wander_std_m
    if barometer is not None:
        stds[S.BARO_OFFSET] = barometer.offset_std_pa
        stds[S.BARO_WANDER], stds[S.FAN] = barometer.wander_std_pa, barometer.fan_step_pa
    return stds
