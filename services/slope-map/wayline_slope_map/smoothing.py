"""Pure: a run's altitude and grade, filtered forwards and smoothed backwards (papers/004).

The model is the one that fusion filters with as the vehicle drives (`wayline.vertical`), and
altitudes are believed by the same rules; here the run is known to its end, so that the backward
pass (Rauch, Tung and Striebel) leaves no lag and needs no time shifts (section 5.2.3).
"""

import math
from typing import NamedTuple

import msgspec
import numpy as np
from numpy.typing import NDArray

from wayline.likelihood import Measurement, nis_of, threshold, weighed
from wayline.line import Floats
from wayline.noise_scale import NoiseScale
from wayline.tuning import Tuning
from wayline.vertical.bound import at_most
from wayline.vertical.filter import VerticalFilter
from wayline.vertical.loading import Loading
from wayline.vertical.model import Pushed, Transition
from wayline.vertical.smoother import rts
from wayline.vertical.states import VerticalStates
from wayline.vertical.trust import (
    LIKELY_PROBABILITY,
    PRESSURE_FACTOR_MIN,
    TORQUE_FACTOR_MIN,
    AltitudeTrust,
    is_believable_mass,
)
from wayline_slope_map import bends
from wayline_slope_map.altitudes import Measured
from wayline_slope_map.bends import Learned
from wayline_slope_map.slopes import NO_SLOPES, Slopes, Window

S = VerticalStates
FIRST_ALTITUDE_STD_M = 100.0
"""Of the median of the first altitudes."""
FIRST_ALTITUDES = 15
PASSES = 3
"""A fourth changes grades by hundredths of a percent."""
UNBELIEVABLE_SHARE = 0.2
"""Of a run's slopes."""
BAROMETER, ASKED, FIRST_SLOPE = -1, -2, -3
"""In place of a receiver's number; -3 is the first of the slopes, -4 the next."""


class Sensed(NamedTuple):
    """What a run is smoothed by."""

    gps: Measured
    barometer: Measured
    slopes: Slopes


class Smoothed(NamedTuple):
    """Altitude and grade with their stds, shape (n,) each."""

    alt_m: Floats
    alt_std_m: Floats
    grade_pct: Floats
    grade_std_pct: Floats
    is_such_vehicle: bool = True
    """False where none of the run's torque counts, by the mass that it comes to."""


class _Nodes(NamedTuple):
    """The places of a run at which something is measured or asked, in order of travel."""

    times_s: Floats
    travelled_m: Floats
    value: Floats
    """An altitude in m, or a share of `Slopes`; NaN where the node is asked only."""
    std: Floats
    sensor: NDArray[np.intp]
    """A receiver's number, or one of those below 0."""
    asked: NDArray[np.intp]
    """For every node the index of what is asked there, -1 where nothing is."""


def smooth(
    sensed: Sensed, times_s: Floats, travelled_m: Floats, tuning: Tuning, passes: int = PASSES
) -> Smoothed | None:
    """Smoothed values where asked for, shape (n,); None with fewer than two measurements.

    The k-th value is asked for at `travelled_m[k]`, reached at `times_s[k]`, in any order. What a
    pass tells of the road's bends and of torque's bias is what the next one starts from. Where
    torque comes to a mass that no such vehicle has, none of the run's counts.
    """
    if sum(len(measured.times_s) for measured in sensed) < 2:
        return None
    if not len(sensed.gps.alt_m) and not len(sensed.barometer.alt_m):
        tuning = msgspec.structs.replace(tuning, vertical_sensors=("torque", "vehicle"))
    nodes = _nodes(sensed, times_s, travelled_m)
    is_learned = len(sensed.slopes.share) >= bends.FEWEST_SLOPES
    is_told = is_learned and len(sensed.barometer.alt_m) > 0
    start = bends.first(len(nodes.times_s), tuning, is_told=is_told)
    learn = bends.learned if is_learned else bends.calmed
    forward = _ForwardPass(sensed, tuning, start)
    x, P = forward.smoothed(nodes)
    if forward.is_no_such_vehicle:
        others = sensed._replace(slopes=NO_SLOPES)
        smoothed = smooth(others, times_s, travelled_m, tuning, passes)
        return None if smoothed is None else smoothed._replace(is_such_vehicle=False)
    for _ in range(passes - 1):
        start = learn(nodes.travelled_m, x, P, tuning, start)
        x, P = _ForwardPass(sensed, tuning, start).smoothed(nodes)
    at = nodes.asked >= 0
    order = np.argsort(nodes.asked[at])
    x, P = x[at][order], P[at][order]
    return Smoothed(
        alt_m=x[:, S.ALTITUDE],
        alt_std_m=np.sqrt(P[:, S.ALTITUDE, S.ALTITUDE]),
        grade_pct=100.0 * x[:, S.SLOPE],
        grade_std_pct=100.0 * np.sqrt(P[:, S.SLOPE, S.SLOPE]),
    )


def _nodes(sensed: Sensed, times_s: Floats, travelled_m: Floats) -> _Nodes:
    gps, barometer, slopes = sensed
    asked, altitudes = len(times_s), len(gps.alt_m) + len(barometer.alt_m)
    nothing = np.full(asked, np.nan)
    times = np.concatenate((gps.times_s, barometer.times_s, slopes.times_s, times_s))
    travelled = np.concatenate(
        (gps.travelled_m, barometer.travelled_m, slopes.travelled_m, travelled_m)
    )
    order = np.lexsort((times, travelled))
    at_barometer = np.full(len(barometer.alt_m), BAROMETER)
    places = FIRST_SLOPE - np.arange(len(slopes.share))
    measured = altitudes + len(slopes.share)
    return _Nodes(
        times[order],
        travelled[order],
        np.concatenate((gps.alt_m, barometer.alt_m, slopes.share, nothing))[order],
        np.concatenate((gps.std_m, barometer.std_m, slopes.std, nothing))[order],
        np.concatenate((gps.receiver, at_barometer, places, np.full(asked, ASKED)))[order],
        np.concatenate((np.full(measured, -1), np.arange(asked)))[order],
    )


class _ForwardPass:
    """Filters a run forward, and keeps what the backward pass needs of each node."""

    def __init__(self, sensed: Sensed, tuning: Tuning, start: Learned) -> None:
        tuning = msgspec.structs.replace(tuning, torque_bias_std_pct=start.torque_bias_std_pct)
        gps, barometer = sensed.gps, sensed.barometer
        receivers = int(gps.receiver.max()) + 1 if len(gps.receiver) else 1
        self._tuning, self._windows = tuning, sensed.slopes.windows
        self._kalman = kalman = VerticalFilter(tuning, receivers)
        kalman.x[: S.CURVATURE] = _first_state(gps, barometer)
        kalman.P[S.ALTITUDE, S.ALTITUDE] = FIRST_ALTITUDE_STD_M**2
        self._curvature_std = start.curvature_std
        self._trust = [AltitudeTrust() for _ in range(receivers)]
        self._noise, self._slope_noise = NoiseScale(), NoiseScale()
        self._loading = Loading()
        self._gate = threshold(1, tuning.gate_probability)
        self._unbelievable = 0
        """Slopes beside a mass that the vehicle cannot have."""
        # without a barometer nothing but the road's own unrest tells noise from a hill
        self._has_barometer = len(barometer.alt_m) > 0

    @property
    def is_no_such_vehicle(self) -> bool:
        """Whether torque's sign, its unit or the stated mass was wrong for much of the run."""
        return self._unbelievable > UNBELIEVABLE_SHARE * len(self._windows)

    def smoothed(self, nodes: _Nodes) -> tuple[Floats, Floats]:
        """States (n, size) and covariances (n, size, size) given all, before and after."""
        kalman, count, size = self._kalman, len(nodes.times_s), self._kalman.model.size
        steps_m = np.maximum(np.diff(nodes.travelled_m, prepend=nodes.travelled_m[0]), 0.0)
        steps_s = np.maximum(np.diff(nodes.times_s, prepend=nodes.times_s[0]), 0.0)
        x, P = np.empty((count, size)), np.empty((count, size, size))
        F, Q = kalman.model.moves(steps_m, steps_s, self._curvature_std)
        sensors, values, stds = (each.tolist() for each in (nodes.sensor, nodes.value, nodes.std))
        times_ns = np.rint(1e9 * nodes.times_s).astype(np.int64).tolist()
        steps = zip(sensors, times_ns, values, stds, list(F), list(Q), strict=True)
        for k, (sensor, t_ns, value, std, F_k, Q_k) in enumerate(steps):
            self._take(sensor, _Reading(t_ns, value, std), Transition(F_k, Q_k))
            x[k], P[k] = kalman.x, kalman.P
        return rts(x, P, F, Q)

    def _take(self, sensor: int, reading: "_Reading", moved: Transition) -> None:
        """Step to where something was measured and correct with it.

        What moves the state before the correction is written into the step, for the way back.
        """
        if sensor <= FIRST_SLOPE:
            window = self._windows[FIRST_SLOPE - sensor]
            if window is not None:
                self._begin(window, reading.t_ns, moved)
            self._kalman.step(moved)
            self._take_slope(reading, window)
            return
        self._kalman.step(moved)
        if sensor == BAROMETER:
            self._take_pressure(reading)
        elif sensor != ASKED:
            self._take_altitude(sensor, reading, moved)

    def _begin(self, window: Window, t_ns: int, moved: Transition) -> None:
        """Let a window of torque begin; after a stand the vehicle may have been loaded."""
        self._kalman.model.handed_over(moved, window.speed_std_mps, goes_on=window.goes_on)
        if self._loading.is_doubted(t_ns):
            moved.Q[S.INVERSE_MASS, S.INVERSE_MASS] += self._kalman.model.load_std**2
        self._loading = Loading(t_ns)

    def _take_slope(self, reading: "_Reading", window: Window | None) -> None:
        """Correct with a slope of the engine, unless it is unlikely."""
        kalman, noise, std = self._kalman, self._slope_noise, reading.std
        noisy = math.sqrt(noise.factor) * std
        if window is None:
            measurement = kalman.model.own_slope(kalman.x, reading.value, noisy)
        else:
            pushed = Pushed(window.length_s, reading.value, window.level)
            measurement = kalman.model.torque(kalman.x, pushed, noisy)
        if not is_believable_mass(kalman.mass):
            self._unbelievable += 1
            return
        expected = kalman.expected(measurement)
        is_likely = self._is_likely(measurement, expected)
        if window is not None and window.is_braked:
            if float(measurement.y[0]) > 0.0 and is_likely:
                kalman.correct(at_most(measurement, expected))
            return
        square = float(measurement.y[0]) ** 2
        self._slope_noise = noise.learned(square, float(expected[0, 0]), std**2, TORQUE_FACTOR_MIN)
        if is_likely:
            kalman.correct(weighed(measurement, expected, LIKELY_PROBABILITY))

    def _take_pressure(self, reading: "_Reading") -> None:
        kalman, noise, (_, alt_m, std_m) = self._kalman, self._noise, reading
        noisy_m = math.sqrt(noise.factor) * std_m
        measurement = kalman.model.barometer(kalman.x, alt_m, noisy_m)
        expected = kalman.expected(measurement)
        square = float(measurement.y[0]) ** 2
        self._noise = noise.learned(square, float(expected[0, 0]), std_m**2, PRESSURE_FACTOR_MIN)
        kalman.correct(weighed(measurement, expected, self._tuning.gate_probability))

    def _take_altitude(self, receiver: int, reading: "_Reading", moved: Transition) -> None:
        kalman, trust, (t_ns, alt_m, std_m) = self._kalman, self._trust[receiver], reading
        slow_std_m, before_m = kalman.model.slow_std_m(std_m), trust.slow_std_m
        renewal = before_m and kalman.project_error(receiver, before_m, slow_std_m)
        if renewal:
            _go_on(moved, renewal)
        if renewal or before_m is None:
            trust = msgspec.structs.replace(trust, slow_std_m=slow_std_m)
        measurement = kalman.model.gps_altitude(kalman.x, receiver, alt_m, std_m)
        expected = kalman.expected(measurement)
        if self._is_likely(measurement, expected):
            if self._has_barometer:
                measurement = weighed(measurement, expected, LIKELY_PROBABILITY)
            kalman.correct(measurement)
            trust = trust.after_accepted(t_ns) if trust.accepted_ns else trust.after_set(t_ns)
        else:
            off_m = float(measurement.y[0])
            trust = trust.after_rejected(t_ns, off_m, std_m)
            if trust.is_won(self._tuning):
                moved.Q[...] += kalman.inflate_altitude(off_m)
                kalman.correct(measurement)
                trust = trust.after_set(t_ns)
        self._trust[receiver] = trust

    def _is_likely(self, measurement: Measurement, expected: Floats) -> bool:
        return nis_of(measurement, expected) <= self._gate


class _Reading(NamedTuple):
    """What was measured at a place; `value` and `std` as in `_Nodes`."""

    t_ns: int
    value: float
    std: float


def _go_on(moved: Transition, then: Transition) -> None:
    """Let another step follow, written over the first."""
    F, Q = moved
    F[...] = then.F @ F
    Q[...] = then.F @ Q @ then.F.T + then.Q


def _first_state(gps: Measured, barometer: Measured) -> tuple[float, float, float]:
    """Altitude, slope and bias, by medians of the first altitudes: any one may be far out."""
    baro_m = float(np.median(barometer.alt_m[:FIRST_ALTITUDES])) if len(barometer.alt_m) else None
    gps_m = float(np.median(gps.alt_m[:FIRST_ALTITUDES])) if len(gps.alt_m) else None
    if baro_m is None or gps_m is None:
        return (baro_m or gps_m or 0.0), 0.0, 0.0
    return gps_m, 0.0, baro_m - gps_m
