"""Pure: how altitude, slope and curvature of a road change with distance.

Curvature is a first-order Gauss-Markov process over distance, and slope and altitude its integrals:
the model that Singer (1970) has for a target's acceleration over time.
"""

import math
from typing import Any, NamedTuple

import numpy as np

from wayline.likelihood import Floats
from wayline.vertical.states import VerticalStates

S = VerticalStates
LEVELLING_M = 2_000.0
"""Over which a road turns back to level: did slopes wander without an end, the walls of a town
would make slopes that no road has. Steps are far shorter, so that Q stays as it is."""
SHORT_SHARE = 0.05
"""Of the correlation length: below, the closed form loses its digits and the first term does."""


class Road:
    """A road whose curvature has a std (tangent of the slope for a metre) and a length."""

    def __init__(self, curvature_std: float, length_m: float) -> None:
        self.curvature_std, self._length_m = curvature_std, length_m

    def move(self, F: Floats, Q: Floats, distance_m: float) -> None:
        """Write F and Q over a distance driven forward (negative in reverse)."""
        share = abs(distance_m) / self._length_m
        kept, lost = math.exp(-share), -math.expm1(-share)
        rows = _short(share) if share < SHORT_SHARE else _long(share, kept)
        level = math.exp(-abs(distance_m) / LEVELLING_M)
        step = _Step(distance_m, math.copysign(1.0, distance_m), share, kept, lost, level)
        self._write(F, Q, step, rows, self.curvature_std**2)

    def moves(self, F: Floats, Q: Floats, distances_m: Floats, curvature_stds: Floats) -> None:
        """As `move`, of many steps, shape (n,) each; F and Q have the shape (size, size, n)."""
        share = np.abs(distances_m) / self._length_m
        kept, lost = np.exp(-share), -np.expm1(-share)
        rows = np.where(share < SHORT_SHARE, _short(share), _long(share, kept))
        level = np.exp(-np.abs(distances_m) / LEVELLING_M)
        step = _Step(distances_m, np.copysign(1.0, distances_m), share, kept, lost, level)
        self._write(F, Q, step, tuple(rows), curvature_stds**2)

    def _write(self, F: Floats, Q: Floats, step: "_Step", rows: "Rows", variance: "Number") -> None:
        length_m = self._length_m
        F[S.ALTITUDE, S.SLOPE] = step.distance_m
        F[S.ALTITUDE, S.CURVATURE] = length_m**2 * (step.share - step.lost)
        F[S.SLOPE, S.CURVATURE] = step.sign * length_m * step.lost
        F[S.SLOPE, S.SLOPE] = step.level
        F[S.CURVATURE, S.CURVATURE] = step.kept
        altitude, altitude_slope, altitude_curvature, slope, slope_curvature, curvature = rows
        Q[S.ALTITUDE, S.ALTITUDE] = variance * length_m**4 * altitude
        Q[S.SLOPE, S.SLOPE] = variance * length_m**2 * slope
        Q[S.CURVATURE, S.CURVATURE] = variance * curvature
        across = step.sign * variance * length_m**3 * altitude_slope
        Q[S.ALTITUDE, S.SLOPE] = Q[S.SLOPE, S.ALTITUDE] = across
        across = variance * length_m**2 * altitude_curvature
        Q[S.ALTITUDE, S.CURVATURE] = Q[S.CURVATURE, S.ALTITUDE] = across
        across = step.sign * variance * length_m * slope_curvature
        Q[S.SLOPE, S.CURVATURE] = Q[S.CURVATURE, S.SLOPE] = across


Number = Any
"""A float, or floats of as many steps, shape (n,): the formulas are one."""


class _Step(NamedTuple):
    """A distance, its sign and its share of the correlation length, and what it leaves."""

    distance_m: Number
    sign: Number
    share: Number
    kept: Number
    lost: Number
    level: Number
    """What is left of a slope."""


Rows = tuple[Number, ...]
"""Upper triangle of Q, altitude, slope and curvature, for a length and a std of 1."""


def _short(u: Number) -> Rows:
    return u**5 / 10.0, u**4 / 4.0, u**3 / 3.0, 2.0 * u**3 / 3.0, u**2, 2.0 * u


def _long(u: Number, kept: Number) -> Rows:
    twice = kept * kept
    return (
        1.0 - twice + 2.0 * u + 2.0 * u**3 / 3.0 - 2.0 * u**2 - 4.0 * u * kept,
        1.0 + twice - 2.0 * kept + 2.0 * u * kept - 2.0 * u + u**2,
        1.0 - twice - 2.0 * u * kept,
        4.0 * kept - 3.0 - twice + 2.0 * u,
        twice + 1.0 - 2.0 * kept,
        1.0 - twice,
    )
