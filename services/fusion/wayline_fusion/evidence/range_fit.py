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

from wayline.satellites.range_noise import Signals, one_sided
from wayline.satellites.sight import Ground, seen_from
from wayline_fusion.intake.events import Ranges

Floats = NDArray[np.float64]

APART_M = 3.0
APART_NS = 1_000_000_000
"""Epochs that are nearer to the last one, in way and time, tell nothing new."""
SPAN_NS = 120_000_000_000
SEEN_MAX = 120
FITTED_MIN = 8
SPREAD_MIN_M = 15.0
"""A way whose places are no farther from their middle has no direction."""
ROUNDS = (8.0, 4.0, 2.0, 1.0, 1.0, 1.0, 1.0, 1.0)
"""How much more than in the end each round of weighing bears."""
TURNS = 4
"""Rounds of turning the way; each leaves the square of what was wrong."""
SCALE_STD = 0.03
"""Of the wheels."""
CORRELATED_M = 15.0
"""A reflection lasts so long a way."""


class Heard(NamedTuple):
    """An epoch, and where reckoning was: east + i north, in metres."""

    ranges: Ranges
    reckoned_m: complex
    biased_s: float
    """For how long the gyro's bias has turned the reckoned way."""


class Known(NamedTuple):
    """Before any fit, of the gyro's bias, clockwise, and of a strong range from the zenith."""

    bias_radps: float
    bias_std_radps: float
    range_std_floor_m: float


class RangeFit(NamedTuple):
    """How the reckoned way lies on the map."""

    place_m: complex
    """Of the vehicle now, east + i north of the ground that was given."""
    height_m: float
    """Above that ground."""
    height_std_m: float
    turn_rad: float
    """From headings as reckoned now to true ones, clockwise."""
    bias_radps: float
    """Of the gyro, clockwise."""
    covariance: Floats
    """Of east, north, heading and bias."""

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

    def fit(self, now: Heard, ground: Ground, known: Known) -> RangeFit | None:
        """The way as it lies about a ground within a few kilometres; None of too few epochs."""
        if len(self.heard) < FITTED_MIN:
            return None
        way = _unbent(self.heard, now, known.bias_radps)
        if float(np.mean(np.abs(way - way.mean()) ** 2)) < SPREAD_MIN_M**2:
            return None
        lines = _lines(self.heard, way, ground, now, known.range_std_floor_m)
        turned, (solution, covariance) = _rigid(lines, _turn_of(lines), known.bias_std_radps)
        # so many epochs have the same reflections
        alike = max(len(way) * CORRELATED_M / max(float(np.ptp(np.abs(way))), CORRELATED_M), 1.0)
        told = alike * covariance
        # complex angles are counter-clockwise from east, headings clockwise from north
        of_reckoning, signs = [0, 1, 3, 4], np.array([1.0, 1.0, -1.0, 1.0])
        return RangeFit(
            complex(solution[0], solution[1]),
            float(solution[2]),
            math.sqrt(float(told[2, 2])),
            -cmath.phase(turned),
            known.bias_radps + float(solution[4]),
            told[np.ix_(of_reckoning, of_reckoning)] * np.outer(signs, signs),
        )


class Lines(NamedTuple):
    """All ranges of all epochs, a row each."""

    off_m: Floats
    """Measured less geometric, from the ground given."""
    stds_m: Floats
    directions: Floats
    """East, north and up; shape (n, 3)."""
    others: Floats
    """A column for each system but the first one; shape (n, systems - 1)."""
    way: NDArray[np.complex128]
    """Where the vehicle was, from where it is now, as reckoned."""
    bent: NDArray[np.complex128]
    """What turning all of it by 1 rad/s, counter-clockwise, would move that by."""
    starts: NDArray[np.int64]
    """Where each epoch's rows begin."""

    def by_place(self, moves: NDArray[np.complex128]) -> Floats:
        """How much longer each range becomes when its place moves east + i north."""
        east, north, _ = self.directions.T
        return np.asarray(-(east * moves.real + north * moves.imag))

    def centred(self, values: Floats, weights: Floats) -> Floats:
        """Values, shape (n, columns), without each epoch's mean: whatever its clock says."""
        total = np.add.reduceat(weights, self.starts)
        means = np.add.reduceat(weights[:, None] * values, self.starts) / total[:, None]
        counts = np.diff(np.append(self.starts, len(weights)))
        return np.asarray(values - np.repeat(means, counts, axis=0))


def _lines(
    heard: Sequence[Heard],
    way: NDArray[np.complex128],
    ground: Ground,
    now: Heard,
    floor_m: float,
) -> Lines:
    epochs = [each.ranges for each in heard]
    counts = [len(each.names) for each in epochs]
    sight = seen_from(
        ground,
        np.concatenate([each.places_m for each in epochs]),
        np.concatenate([each.motions_mps for each in epochs]),
    )
    systems = np.concatenate([each.systems for each in epochs])
    others = [systems == name for name in sorted(set(systems))[1:]]
    claimed_m = np.concatenate([each.stds_m for each in epochs])
    cn0_dbhz = np.concatenate([each.cn0_dbhz for each in epochs])
    return Lines(
        np.concatenate([each.pseudoranges_m for each in epochs]) - sight.ranges_m,
        Signals(claimed_m, sight.directions[:, 2], cn0_dbhz).stds_m(floor_m),
        sight.directions,
        np.array(others, dtype=np.float64).reshape(len(others), -1).T,
        np.repeat(way, counts),
        np.repeat(_bent(heard, now, way), counts),
        np.cumsum([0, *counts[:-1]]),
    )


def _unbent(heard: Sequence[Heard], now: Heard, bias_radps: float) -> NDArray[np.complex128]:
    """The reckoned way without the gyro's bias, as seen from where it has come now."""
    way = np.array([each.reckoned_m for each in (*heard, now)])
    # headings are clockwise, complex angles are not: a bias taken off turns it the other way
    steps = np.diff(way) * np.exp(1j * bias_radps * _middles_s(heard, now))
    return np.asarray(-np.cumsum(steps[::-1])[::-1])


def _bent(
    heard: Sequence[Heard], now: Heard, way: NDArray[np.complex128]
) -> NDArray[np.complex128]:
    steps = np.diff(np.append(way, 0.0))
    return np.asarray(-np.cumsum((1j * _middles_s(heard, now) * steps)[::-1])[::-1])


def _middles_s(heard: Sequence[Heard], now: Heard) -> Floats:
    """Of the steps of the way, for how long a bias has turned them, from now on back."""
    biased_s = np.array([each.biased_s for each in (*heard, now)])
    return np.asarray(0.5 * (biased_s[1:] + biased_s[:-1]) - biased_s[-1])


def _turn_of(lines: Lines) -> complex:
    """From the reckoned way to the true one, the way stretched as it likes: so it is linear."""
    moves = np.column_stack((_by_shift(lines), lines.by_place(lines.way)))
    across = lines.by_place(1j * lines.way)
    columns = np.column_stack((moves, across, lines.others))
    solution = _solved(lines, columns, np.zeros(columns.shape[1])).solution
    turned = complex(solution[3], solution[4])
    return turned / abs(turned)


def _by_shift(lines: Lines) -> Floats:
    """What 1 m to the east, to the north and up makes of each range."""
    return -lines.directions


def _rigid(lines: Lines, turned: complex, bias_std_radps: float) -> tuple[complex, "Solved"]:
    """The turn again, and the rest, with the way about as long as reckoned and a gyro's bias."""
    for _ in range(TURNS):
        placed = turned * lines.way
        columns = np.column_stack(
            (
                _by_shift(lines),
                lines.by_place(1j * placed),
                lines.by_place(turned * lines.bent),
                lines.by_place(placed),
                lines.others,
            )
        )
        prior = np.zeros(columns.shape[1])
        prior[4], prior[5] = bias_std_radps**-2, SCALE_STD**-2
        left = lines._replace(off_m=lines.off_m - lines.by_place(placed))
        solved = _solved(left, columns, prior)
        turned *= cmath.exp(1j * solved.solution[3])
    return turned, solved


class Solved(NamedTuple):
    """Of a weighed least-squares problem."""

    solution: Floats
    covariance: Floats


def _solved(lines: Lines, columns: Floats, prior: Floats) -> Solved:
    """Reflections weighed down round by round; `prior` is the information of each unknown at 0."""
    weights = lines.stds_m**-2
    for wide in (*ROUNDS, None):
        free = lines.centred(columns, weights)
        off_m = lines.centred(lines.off_m[:, None], weights)[:, 0]
        weighed = weights[:, None] * free
        covariance = np.linalg.inv(free.T @ weighed + np.diag(prior))
        solution = covariance @ (weighed.T @ off_m)
        if wide is not None:
            off = (off_m - free @ solution) / lines.stds_m
            weights = one_sided(off, wide) * lines.stds_m**-2
    return Solved(np.asarray(solution), np.asarray(covariance))
