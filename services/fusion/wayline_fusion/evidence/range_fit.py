"""Pure: the pseudoranges of the last minutes laid over the way that gyro and wheels have reckoned.

Over a few kilometres a range changes evenly with the place, so where the way lies, how it is turned
and how high it is are one least-squares problem, without a first guess of any of them. The clock is
free in each epoch. Reflections lengthen ranges: what is left after a fit tells which ones count, in
rounds that trust the satellites less and less (graduated non-convexity; A. Blake and A. Zisserman,
Visual reconstruction, 1987).
"""

import cmath
import math
from collections.abc import Sequence
from typing import NamedTuple

import msgspec
import numpy as np
from numpy.typing import NDArray

from wayline_fusion.filter.range_noise import one_sided, range_stds_m
from wayline_fusion.filter.sight import Ground, seen_from
from wayline_fusion.intake.events import Ranges

Floats = NDArray[np.float64]

APART_M = 3.0
APART_NS = 1_000_000_000
"""Epochs that are nearer to the last one, in way and time, tell nothing new."""
SPAN_NS = 120_000_000_000
SEEN_MAX = 120
FITTED_MIN = 8
ROUNDS = (8.0, 4.0, 2.0, 1.0, 1.0, 1.0, 1.0, 1.0)
"""How much more than in the end each round of weighing bears."""
SCALE_STD = 0.03
CORRELATED_M = 15.0
"""A reflection lasts so long a way."""


class Heard(NamedTuple):
    """An epoch, and where reckoning was: east + i north, in metres."""

    ranges: Ranges
    reckoned_m: complex
    biased_s: float
    """For how long the gyro's bias has turned the reckoned way."""


class RangeFit(NamedTuple):
    """How the reckoned way lies on the map."""

    place_m: complex
    """Of the vehicle now, east + i north of the ground that was given."""
    height_m: float
    """Above that ground."""
    turn_rad: float
    """From headings as reckoned now to true ones, clockwise."""
    bias_radps: float
    """Of the gyro, clockwise."""
    covariance: Floats
    """Of east, north, heading and bias."""
    height_std_m: float

    @property
    def turn_std_rad(self) -> float:
        """Of the heading."""
        return math.sqrt(float(self.covariance[2, 2]))


class RangeTrack(msgspec.Struct, frozen=True):
    """Of one vehicle."""

    heard: tuple[Heard, ...] = ()

    def with_epoch(self, heard: Heard) -> "RangeTrack":
        """With an epoch that is far enough from the last one."""
        if self.heard:
            last = self.heard[-1]
            is_near = abs(heard.reckoned_m - last.reckoned_m) < APART_M
            if is_near or heard.ranges.t_ns - last.ranges.t_ns < APART_NS:
                return self
        oldest_ns = heard.ranges.t_ns - SPAN_NS
        kept = tuple(each for each in self.heard if each.ranges.t_ns >= oldest_ns)
        return RangeTrack((*kept, heard)[-SEEN_MAX:])

    def fit(
        self, now: Heard, ground: Ground, bias_radps: float, bias_std_radps: float
    ) -> RangeFit | None:
        """The way as it lies about a ground within a few kilometres; None of too few epochs."""
        if len(self.heard) < FITTED_MIN:
            return None
        way = _unbent(self.heard, now, bias_radps)
        if float(np.mean(np.abs(way - way.mean()) ** 2)) < (5 * APART_M) ** 2:
            return None
        lines = _lines(self.heard, way, ground, now)
        return _solved(lines, bias_radps, bias_std_radps, float(np.ptp(np.abs(way))))


class Lines(NamedTuple):
    """All ranges of all epochs, a row each."""

    off_m: Floats
    """Measured less geometric, from the ground given."""
    stds_m: Floats
    directions: Floats
    way_m: NDArray[np.complex128]
    """From where the vehicle is now to where it was."""
    bent_s: NDArray[np.complex128]
    """What a turn of the way by 1 rad/s would move it by, counter-clockwise, unturned."""
    others: Floats
    """A column for each system but the first one; shape (n, systems - 1)."""
    starts: NDArray[np.int64]
    """Where each epoch's rows begin."""


def _lines(heard: Sequence[Heard], way: NDArray, ground: Ground, now: Heard) -> Lines:
    epochs = [each.ranges for each in heard]
    counts = [len(each.names) for each in epochs]
    sight = seen_from(
        ground,
        np.concatenate([each.places_m for each in epochs]),
        np.concatenate([each.motions_mps for each in epochs]),
    )
    systems = np.concatenate([each.systems for each in epochs])
    others = [systems == name for name in sorted(set(systems))[1:]]
    biased_s = np.array([each.biased_s for each in heard]) - now.biased_s
    steps = np.diff(np.append(way, 0.0))
    # a turn per second that ended now has turned an earlier step by so much the other way
    bent = -np.cumsum((steps * 1j * biased_s)[::-1])[::-1]
    claimed_m = np.concatenate([each.stds_m for each in epochs])
    cn0_dbhz = np.concatenate([each.cn0_dbhz for each in epochs])
    return Lines(
        np.concatenate([each.pseudoranges_m for each in epochs]) - sight.ranges_m,
        range_stds_m(claimed_m, sight.directions[:, 2], cn0_dbhz),
        sight.directions,
        np.repeat(way, counts),
        np.repeat(bent, counts),
        np.array(others, dtype=np.float64).reshape(len(others), -1).T,
        np.cumsum([0, *counts[:-1]]),
    )


def _unbent(heard: Sequence[Heard], now: Heard, bias_radps: float) -> NDArray[np.complex128]:
    """The reckoned way without the gyro's bias, as seen from where it has come now."""
    seen = (*heard, now)
    way = np.array([each.reckoned_m for each in seen])
    biased_s = np.array([each.biased_s for each in seen])
    middles_s = 0.5 * (biased_s[1:] + biased_s[:-1]) - biased_s[-1]
    # headings are clockwise, complex angles are not: a bias taken off turns it the other way
    steps = np.diff(way) * np.exp(1j * bias_radps * middles_s)
    return -np.cumsum(steps[::-1])[::-1]


def _solved(
    lines: Lines, bias_radps: float, bias_std_radps: float, length_m: float
) -> RangeFit | None:
    east, north, up = lines.directions.T
    way = lines.way_m
    # first the way may be turned and stretched as it likes
    similar = np.column_stack(
        (
            -east,
            -north,
            -up,
            -(east * way.real + north * way.imag),
            east * way.imag - north * way.real,
            lines.others,
        )
    )
    free = np.zeros(similar.shape[1])
    solution, _ = _rounds(lines, similar, free)
    turned = complex(solution[3], solution[4])
    turned /= abs(turned)
    # then it keeps its length about as it is, and the gyro's bias may bend it
    for _ in range(4):
        placed = turned * way
        moved = 1j * placed
        bent = turned * lines.bent_s
        rigid = np.column_stack(
            (
                -east,
                -north,
                -up,
                -(east * moved.real + north * moved.imag),
                -(east * placed.real + north * placed.imag),
                -(east * bent.real + north * bent.imag),
                lines.others,
            )
        )
        prior = np.zeros(rigid.shape[1])
        prior[4], prior[5] = SCALE_STD**-2, bias_std_radps**-2
        off_m = lines.off_m + east * placed.real + north * placed.imag
        solution, covariance = _rounds(lines._replace(off_m=off_m), rigid, prior)
        turned *= cmath.exp(1j * solution[3])
    alike = max(len(lines.starts) / max(length_m / CORRELATED_M, 1.0), 1.0)
    kept = np.array([0, 1, 3, 5])
    signs = np.array([1.0, 1.0, -1.0, 1.0])
    return RangeFit(
        complex(solution[0], solution[1]),
        float(solution[2]),
        -cmath.phase(turned),
        bias_radps + float(solution[5]),
        alike * covariance[np.ix_(kept, kept)] * np.outer(signs, signs),
        math.sqrt(alike * float(covariance[2, 2])),
    )


def _rounds(lines: Lines, columns: Floats, prior: Floats) -> tuple[Floats, Floats]:
    """Solution and covariance; `prior` is the information of each unknown about 0."""
    weights = lines.stds_m**-2
    left_m = np.zeros(len(weights))
    for number, wide in enumerate((math.inf, *ROUNDS)):
        if number:
            weights = one_sided(left_m / lines.stds_m, wide) * lines.stds_m**-2
        total = np.add.reduceat(weights, lines.starts)
        counts = np.diff(np.append(lines.starts, len(weights)))

        def centred(values: Floats) -> Floats:
            means = np.add.reduceat(weights * values, lines.starts) / total
            return values - np.repeat(means, counts)

        free = np.column_stack([centred(column) for column in columns.T])
        off_m = centred(lines.off_m)
        normal = free.T @ (weights[:, None] * free) + np.diag(prior)
        covariance = np.linalg.inv(normal)
        solution = covariance @ (free.T @ (weights * off_m))
        left_m = off_m - free @ solution
    return solution, covariance
