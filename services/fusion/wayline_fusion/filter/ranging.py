"""Pure: the horizontal filter with what pseudoranges need besides (papers/001, 2 b).

The receiver's clock is the usual two-state model (R. G. Brown and P. Y. C. Hwang, Introduction to
random signals and applied Kalman filtering, chapter 9): bias and drift, both driven by white noise.
Each system but the first keeps its time by itself, so each has an offset of its own.
"""

import math

import numpy as np

from wayline.likelihood import Measurement
from wayline.tuning import Tuning
from wayline_fusion.filter.horizontal import DrivingNoise, HorizontalFilter
from wayline_fusion.filter.states import SIZE, Floats

OTHER_SYSTEMS = ("glonass", "galileo", "beidou", "qzss", "sbas", "navic")
"""All but GPS, whose time the clock is held against."""


class RangingStates:
    """Places in the state vector behind those of `States`, with the unit of each."""

    CLOCK = SIZE  # m, of the receiver against GPS time
    CLOCK_DRIFT = SIZE + 1  # m/s
    HEIGHT = SIZE + 2  # m above the ellipsoid
    SLOPE = SIZE + 3  # tangent, uphill along the heading
    OFFSETS = SIZE + 4  # m, one for each of OTHER_SYSTEMS


R = RangingStates
RANGING_SIZE = R.OFFSETS + len(OTHER_SYSTEMS)
CLOCK_UNKNOWN_M = 3e5
"""Receivers keep within a millisecond; whole ones more are told by their number."""
DRIFT_UNKNOWN_MPS = 300.0
"""A crystal is off by a millionth."""
HEIGHT_UNKNOWN_M = 500.0
OFFSET_WALK_M_PER_SQRT_S = 0.02


class RangingFilter(HorizontalFilter):
    """`HorizontalFilter` with the receiver's clock, the height and an offset a system."""

    def __init__(self, tuning: Tuning) -> None:
        super().__init__(tuning, RANGING_SIZE)

    def _initial_stds(self) -> list[float]:
        offsets = [CLOCK_UNKNOWN_M] * len(OTHER_SYSTEMS)
        slope = 0.01 * self._tuning.slope_std_pct
        unknown = [CLOCK_UNKNOWN_M, DRIFT_UNKNOWN_MPS, HEIGHT_UNKNOWN_M, slope, *offsets]
        return [*super()._initial_stds(), *unknown]

    def advance(
        self, dt_s: float, turn_rad: float | None, noise: DrivingNoise, *, standing: bool
    ) -> None:
        """Predict over a step of at most a few tenths of a second.

        The clock goes on by itself; height and slope (a first-order Gauss-Markov process) by the
        way that is driven.
        """
        moved_m = self.speed_mps * dt_s
        self._set_clock(dt_s)
        kept = self._set_slope(moved_m)
        for offset in range(R.OFFSETS, RANGING_SIZE):
            self.Q[offset, offset] = OFFSET_WALK_M_PER_SQRT_S**2 * dt_s
        super().advance(dt_s, turn_rad, noise, standing=standing)
        self.x[R.CLOCK] += self.x[R.CLOCK_DRIFT] * dt_s
        self.x[R.HEIGHT] += self.x[R.SLOPE] * moved_m
        self.x[R.SLOPE] *= kept

    def _set_slope(self, moved_m: float) -> float:
        """Model and noise over a way; what is kept of the slope."""
        tuning = self._tuning
        kept = math.exp(-abs(moved_m) / tuning.slope_length_m)
        self.F[R.HEIGHT, R.SLOPE], self.F[R.SLOPE, R.SLOPE] = moved_m, kept
        self.Q[R.SLOPE, R.SLOPE] = (0.01 * tuning.slope_std_pct) ** 2 * (1.0 - kept**2)
        return kept

    def _set_clock(self, dt_s: float) -> None:
        self.F[R.CLOCK, R.CLOCK_DRIFT] = dt_s
        Q, tuning = self.Q, self._tuning
        bias = tuning.clock_noise_m_per_sqrt_s**2
        drift = tuning.clock_drift_walk_mps_per_sqrt_s**2
        Q[R.CLOCK, R.CLOCK] = bias * dt_s + drift * dt_s**3 / 3.0
        Q[R.CLOCK, R.CLOCK_DRIFT] = Q[R.CLOCK_DRIFT, R.CLOCK] = 0.5 * drift * dt_s**2
        Q[R.CLOCK_DRIFT, R.CLOCK_DRIFT] = drift * dt_s

    def expected(self, measurement: Measurement) -> Floats:
        """Covariance of the innovation without the measurement's own noise, H P H'."""
        H = measurement.H
        known = H.shape[1]
        predicted: Floats = H.dot(self.P[:known, :known]).dot(H.T)
        return predicted

    def correct(self, measurement: Measurement) -> None:
        """Update the state; a measurement that knows of no satellites has fewer columns."""
        H = measurement.H
        if H.shape[1] < RANGING_SIZE:
            widened = np.zeros((len(H), RANGING_SIZE))
            widened[:, : H.shape[1]] = H
            measurement = measurement._replace(H=widened)
        super().correct(measurement)

    def reset_motion(self) -> None:
        """Forget position, heading, speed, height and clock; keep the sensors' calibration."""
        super().reset_motion()
        initial = self._initial_stds()
        for state in range(SIZE, RANGING_SIZE):
            self.reset_ranging(state, initial[state], 0.0)

    def step_clock(self, step_m: float) -> None:
        """Set the clock forward by a step, as sure of it as before."""
        self.x = self.x.copy()
        self.x[R.CLOCK] += step_m

    def reset_ranging(self, state: int, std: float, value: float | None = None) -> None:
        """Trust clock, drift, height or an offset so much, and forget what others say of it."""
        self.reset_std(state, std)
        if value is not None:
            self.x = self.x.copy()
            self.x[state] = value
