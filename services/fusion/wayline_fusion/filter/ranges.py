"""Pure: what pseudoranges and range rates measure of the state, linearised at it, and their judging.

Each is judged by what the filter and all others of its epoch say of it: with S the covariance of
the innovations y, the i-th lies (S^-1 y)_i / (S^-1)_ii from there, with a variance of 1 / (S^-1)_ii
(data snooping; W. Baarda, A testing procedure for use in geodetic networks, 1968).
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wayline.tuning import Tuning
from wayline_fusion.filter.range_noise import one_sided, range_stds_m, two_sided
from wayline_fusion.filter.ranging import OTHER_SYSTEMS, RangingStates
from wayline_fusion.filter.sight import SPEED_OF_LIGHT_MPS, Ground, Sight, seen_from
from wayline_fusion.filter.states import Floats, States
from wayline_fusion.intake.events import Ranges

S, R = States, RangingStates


MILLISECOND_M = 1e-3 * SPEED_OF_LIGHT_MPS
STEPPED_MIN = 3
"""Satellites that tell of a step of the clock by less than a millisecond."""
STEP_REST_M = 1_000.0
"""A step is one of whole milliseconds when so little of it is left."""


class Lines(NamedTuple):
    """Linearised measurements of one epoch, a row each: first its ranges, then its range rates."""

    names: tuple[str, ...]
    """As verdicts call them."""
    rows: NDArray[np.int64]
    """Which satellites of the epoch they are of."""
    is_range: NDArray[np.bool_]
    y: Floats
    H: Floats
    stds: Floats


class Judged(NamedTuple):
    """Measurements of one epoch held against the filter and each other."""

    is_accepted: NDArray[np.bool_]
    off: Floats
    """From what the filter and the others that are accepted say, in stds of that."""

    def refused_share(self, among: NDArray[np.bool_]) -> float:
        """Of some of them."""
        return 1.0 - float(np.mean(self.is_accepted[among])) if among.any() else 0.0


def lines_of(x: Floats, epoch: Ranges, ground: Ground, tuning: Tuning) -> Lines:
    """Of a state, whose place is the ground."""
    sight = seen_from(ground, epoch.places_m, epoch.motions_mps)
    told = np.isfinite(epoch.rates_mps) & np.isfinite(sight.range_rates_mps)
    rows = np.flatnonzero(told)
    y_m, H_m, stds_m = _ranges(x, epoch, sight, tuning)
    y_mps, H_mps, stds_mps = _range_rates(x, epoch, sight, rows, tuning)
    return Lines(
        (
            *(f"gps_raw {name}" for name in epoch.names),
            *(f"gps_raw_rate {epoch.names[row]}" for row in rows),
        ),
        np.concatenate((np.arange(len(y_m)), rows)),
        np.arange(len(y_m) + len(rows)) < len(y_m),
        np.concatenate((y_m, y_mps)),
        np.vstack((H_m, H_mps)),
        np.concatenate((stds_m, stds_mps)),
    )


def offset_state(system: str) -> int | None:
    """Where a system's offset is; None of the one that the clock is held against."""
    return R.OFFSETS + OTHER_SYSTEMS.index(system) if system in OTHER_SYSTEMS else None


def _ranges(
    x: Floats, epoch: Ranges, sight: Sight, tuning: Tuning
) -> tuple[Floats, Floats, Floats]:
    """Innovations, matrix and stds of ranges, from the place of LATENCY ago, with the clock.

    As of fixes, a part of the error is common to all satellites and varies slowly.
    """
    east, north, up = sight.directions.T
    sin, cos = math.sin(x[S.HEADING]), math.cos(x[S.HEADING])
    speed_mps = x[S.ODOMETER_SCALE] * x[S.WHEEL_SPEED]
    along = east * sin + north * cos
    slow_m = math.sqrt(tuning.gps_error_share) * tuning.gps_position_std_floor_m
    H = np.zeros((len(east), len(x)))
    H[:, S.EAST], H[:, S.NORTH], H[:, R.HEIGHT] = -east, -north, -up
    H[:, S.GPS_EAST], H[:, S.GPS_NORTH] = -slow_m * east, -slow_m * north
    H[:, S.LATENCY] = along * speed_mps
    H[:, R.CLOCK] = 1.0
    for row, system in enumerate(epoch.systems):
        offset = offset_state(system)
        if offset is not None:
            H[row, offset] = 1.0
    # in these the range is linear; of place and height `sight` is the value
    linear = [S.GPS_EAST, S.GPS_NORTH, S.LATENCY, R.CLOCK, *range(R.OFFSETS, len(x))]
    y = epoch.pseudoranges_m - sight.ranges_m - H[:, linear] @ x[linear]
    return y, H, range_stds_m(epoch.stds_m, up, epoch.cn0_dbhz)


def _range_rates(
    x: Floats, epoch: Ranges, sight: Sight, rows: NDArray[np.int64], tuning: Tuning
) -> tuple[Floats, Floats, Floats]:
    """Innovations, matrix and stds of the range rates of some satellites."""
    east, north, _ = sight.directions[rows].T
    sin, cos = math.sin(x[S.HEADING]), math.cos(x[S.HEADING])
    wheels_mps, scale = x[S.WHEEL_SPEED], x[S.ODOMETER_SCALE]
    along = east * sin + north * cos
    H = np.zeros((len(rows), len(x)))
    H[:, S.HEADING] = -(east * cos - north * sin) * scale * wheels_mps
    H[:, S.WHEEL_SPEED], H[:, S.ODOMETER_SCALE] = -along * scale, -along * wheels_mps
    H[:, R.CLOCK_DRIFT] = 1.0
    expected_mps = sight.range_rates_mps[rows] - along * scale * wheels_mps + x[R.CLOCK_DRIFT]
    stds_mps = np.fmax(epoch.rate_stds_mps[rows], tuning.range_rate_std_mps)
    return epoch.rates_mps[rows] - expected_mps, H, stds_mps


def judged(y: Floats, covariance: Floats, limit: float) -> Judged:
    """Refuse the most unlikely one as long as one is over the limit (of the squared `off`)."""
    inverse = np.linalg.inv(covariance)
    is_accepted = np.ones(len(y), dtype=bool)
    off = np.zeros(len(y))
    while is_accepted.any():
        kept = np.flatnonzero(is_accepted)
        off[kept] = (inverse[np.ix_(kept, kept)] @ y[kept]) / np.sqrt(inverse[kept, kept])
        worst = kept[int(np.argmax(np.abs(off[kept])))]
        if off[worst] ** 2 <= limit:
            break
        is_accepted[worst] = False
        # without it the inverse is that of the covariance without its row and column
        inverse = inverse - np.outer(inverse[worst], inverse[worst]) / inverse[worst, worst]
    return Judged(is_accepted, off)


def weights_of(lines: Lines, found: Judged) -> Floats:
    """What those count for that are accepted, 0 to 1: long ranges and odd rates for less."""
    return np.where(lines.is_range, one_sided(found.off, 1.0), two_sided(found.off))


def clock_step_m(lines: Lines, found: Judged) -> float | None:
    """By how much the clock seems to have stepped; None where most ranges are as expected."""
    off_m = lines.y[lines.is_range]
    if found.refused_share(lines.is_range) <= 0.5:
        return None
    median_m = float(np.median(off_m))
    whole_m = round(median_m / MILLISECOND_M) * MILLISECOND_M
    if whole_m and abs(median_m - whole_m) < STEP_REST_M:
        return whole_m
    return median_m if len(off_m) >= STEPPED_MIN else None
