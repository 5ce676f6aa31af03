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
from wayline.vertical.filter import VerticalFilter
from wayline.vertical.loading import DOUBT_STD_SHARE, Loading
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
        return smooth(sensed._replace(slopes=NO_SLOPES), times_s, travelled_m, tuning, passes)
    for _ in range(passes - 1):
        start = learn(nodes.travelled_m, x, P, tuning)
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
        x = np.empty((count, size))
        P, F, Q = (np.empty((count, size, size)) for _ in range(3))
        for k in range(count):
            kalman.model.bend(self._curvature_std[k])
            moved = kalman.advance(steps_m[k], steps_s[k])
            F[k], Q[k] = self._take(nodes, k, moved)
            x[k], P[k] = kalman.x, kalman.P
        return rts(x, P, F, Q)

    def _take(self, nodes: _Nodes, k: int, moved: Transition) -> Transition:
        """Correct with what was measured; returns all that moved the state before that."""
        sensor, value, std = int(nodes.sensor[k]), nodes.value[k], nodes.std[k]
        if sensor == BAROMETER:
            self._take_pressure(value, std)
        elif sensor <= FIRST_SLOPE:
            window = self._windows[FIRST_SLOPE - sensor]
            if window is not None:
                moved = self._after_stand(round(1e9 * nodes.times_s[k]), moved)
            return self._take_slope(value, std, window, moved)
        elif sensor != ASKED:
            return self._take_altitude(sensor, value, std, round(1e9 * nodes.times_s[k]), moved)
        return moved

    def _after_stand(self, t_ns: int, moved: Transition) -> Transition:
        """Doubt the mass where the vehicle may have been loaded."""
        before, self._loading = self._loading, Loading(t_ns)
        if not before.is_doubted(t_ns):
            return moved
        return moved._replace(Q=moved.Q + self._kalman.inflate_mass(DOUBT_STD_SHARE))

    def _take_slope(
        self, share: float, std: float, window: Window | None, moved: Transition
    ) -> Transition:
        """Correct with a slope of the engine, unless it is unlikely."""
        kalman, noise = self._kalman, self._slope_noise
        noisy = math.sqrt(noise.factor) * std
        if window is None:
            measurement = kalman.model.own_slope(kalman.x, share, noisy)
        else:
            moved = _after(
                moved, kalman.project_window(window.speed_std_mps, goes_on=window.goes_on)
            )
            pushed = Pushed(window.length_s, share, window.level)
            measurement = kalman.model.torque(kalman.x, pushed, noisy)
        if not is_believable_mass(kalman.mass):
            self._unbelievable += 1
            return moved
        if window is not None and window.is_braked:
            if float(measurement.y[0]) > 0.0 and self._is_likely(measurement):
                kalman.correct(measurement)
            return moved
        expected = kalman.expected(measurement)
        square = float(measurement.y[0]) ** 2
        self._slope_noise = noise.learned(square, float(expected[0, 0]), std**2, TORQUE_FACTOR_MIN)
        if self._is_likely(measurement):
            kalman.correct(weighed(measurement, expected, LIKELY_PROBABILITY))
        return moved

    def _take_pressure(self, alt_m: float, std_m: float) -> None:
        kalman, noise = self._kalman, self._noise
        noisy_m = math.sqrt(noise.factor) * std_m
        measurement = kalman.model.barometer(kalman.x, alt_m, noisy_m)
        expected = kalman.expected(measurement)
        square = float(measurement.y[0]) ** 2
        self._noise = noise.learned(square, float(expected[0, 0]), std_m**2, PRESSURE_FACTOR_MIN)
        kalman.correct(weighed(measurement, expected, self._tuning.gate_probability))

    def _take_altitude(
        self, receiver: int, alt_m: float, std_m: float, t_ns: int, moved: Transition
    ) -> Transition:
        kalman, trust = self._kalman, self._trust[receiver]
        slow_std_m, before_m = kalman.model.slow_std_m(std_m), trust.slow_std_m
        renewal = before_m and kalman.project_error(receiver, before_m, slow_std_m)
        if renewal:
            moved = _after(moved, renewal)
        if renewal or before_m is None:
            trust = msgspec.structs.replace(trust, slow_std_m=slow_std_m)
        measurement = kalman.model.gps_altitude(kalman.x, receiver, alt_m, std_m)
        if self._is_likely(measurement):
            kalman.correct(self._weighed(measurement))
            trust = trust.after_accepted(t_ns) if trust.accepted_ns else trust.after_set(t_ns)
        else:
            off_m = float(measurement.y[0])
            trust = trust.after_rejected(t_ns, off_m, std_m)
            if trust.is_won(self._tuning):
                moved = moved._replace(Q=moved.Q + kalman.inflate_altitude(off_m))
                kalman.correct(measurement)
                trust = trust.after_set(t_ns)
        self._trust[receiver] = trust
        return moved

    def _is_likely(self, measurement: Measurement) -> bool:
        nis = nis_of(measurement, self._kalman.expected(measurement))
        return nis <= threshold(1, self._tuning.gate_probability)

    def _weighed(self, measurement: Measurement) -> Measurement:
        if not self._has_barometer:
            return measurement
        return weighed(measurement, self._kalman.expected(measurement), LIKELY_PROBABILITY)


def _after(moved: Transition, then: Transition) -> Transition:
    """Both in turn."""
    return Transition(then.F @ moved.F, then.F @ moved.Q @ then.F.T + then.Q)


def _first_state(gps: Measured, barometer: Measured) -> tuple[float, float, float]:
    """Altitude, slope and bias, by medians of the first altitudes: any one may be far out."""
    baro_m = float(np.median(barometer.alt_m[:FIRST_ALTITUDES])) if len(barometer.alt_m) else None
    gps_m = float(np.median(gps.alt_m[:FIRST_ALTITUDES])) if len(gps.alt_m) else None
    if baro_m is None or gps_m is None:
        return (baro_m or gps_m or 0.0), 0.0, 0.0
    return gps_m, 0.0, baro_m - gps_m
