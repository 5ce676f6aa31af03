"""Pure: a receiver's clock, from what its satellites' Dopplers and pseudoranges have in common."""

import math
from typing import NamedTuple

import msgspec
import numpy as np

from wayline.noise_scale import NoiseScale
from wayline.satellites.doppler import Floats

WALK_MPS_PER_SQRT_S = 0.1
"""Of a temperature-compensated crystal's drift, before it is learned: half a Hz at L1."""
WALK_SCALE_MIN = 1e-4
LEARNED_OVER_S = 5.0
"""A drift's change over so long tells of its walk; sooner its own noise hides it."""
UNLIKELY = 25.0
"""Squared, in variances: five sigma."""
ALIKE = 3.0
"""What is farther from the middle, in its own stds, has no part in the mean."""


class Shared(NamedTuple):
    """What measurements have in common."""

    value: float
    variance: float


def shared_part(values: Floats, noise: Floats, by_axes: Floats, axes: Floats) -> Shared:
    """Their weighted mean, without those that are far from the middle one; at least one value.

    Each is off by noise of its own (variances, shape (n,)) and, `by_axes` of shape (n, 3), by three
    errors that it shares with the others (variances `axes`).
    """
    variances = noise + np.square(by_axes).dot(axes)
    away = np.square(values - np.median(values))
    alike = away <= ALIKE**2 * np.maximum(variances, np.median(away))
    weights = alike / variances
    weights /= weights.sum()
    own, common = np.square(weights).dot(noise), np.square(weights.dot(by_axes)).dot(axes)
    return Shared(float(weights.dot(values)), float(own + common))


class ClockDrift(msgspec.Struct, frozen=True):
    """How fast a receiver's clock gains, as range rates have it (m/s), with what it may be off.

    One number needs no matrices: a random walk, corrected by its own innovations. How much it
    walks is learned. A jump is believed at once, and doubted by its own size until it lasts.
    """

    t_ns: int
    mps: float
    variance: float
    walk: NoiseScale = NoiseScale()
    compared: tuple[int, float, float] | None = None
    """Instant, drift and variance to which a later drift is compared."""

    @classmethod
    def first(cls, t_ns: int, drift: Shared) -> "ClockDrift":
        """As the first epoch tells it."""
        return cls(t_ns, drift.value, drift.variance)

    def variance_at(self, t_ns: int) -> float:
        """Of the drift at another instant, (m/s)^2."""
        return self.variance + self._walked(abs(t_ns - self.t_ns) * 1e-9)

    def _walked(self, seconds: float) -> float:
        return self.walk.factor * WALK_MPS_PER_SQRT_S**2 * seconds

    def told(self, t_ns: int, drift: Shared) -> "ClockDrift":
        """With what an epoch tells, which is not older than the last one."""
        variance, off = self.variance_at(t_ns), drift.value - self.mps
        if off**2 > UNLIKELY * (variance + drift.variance):
            return ClockDrift(t_ns, drift.value, drift.variance + off**2, self.walk)
        gain = variance / (variance + drift.variance)
        moved = ClockDrift(t_ns, self.mps + gain * off, (1.0 - gain) * variance, self.walk)
        return moved._learned(self.compared or (self.t_ns, self.mps, self.variance))

    def _learned(self, before: tuple[int, float, float]) -> "ClockDrift":
        t_ns, mps, variance = before
        seconds = (self.t_ns - t_ns) * 1e-9
        if seconds < LEARNED_OVER_S:
            return msgspec.structs.replace(self, compared=before)
        claimed = WALK_MPS_PER_SQRT_S**2 * seconds
        square, noise = (self.mps - mps) ** 2, self.variance + variance
        walk = self.walk.learned(square, noise, claimed, WALK_SCALE_MIN)
        here = (self.t_ns, self.mps, self.variance)
        return msgspec.structs.replace(self, walk=walk, compared=here)


def walked_m(drift_std_mps: float, seconds: float) -> float:
    """What a clock's offset may be off after so long, its drift being known to a std."""
    return math.hypot(drift_std_mps, 0.5 * WALK_MPS_PER_SQRT_S * math.sqrt(seconds)) * seconds
