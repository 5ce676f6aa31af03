"""Pure: what pseudoranges and range rates measure of the state, linearised at it, and their judging.

Each is judged by what the filter and all others of its epoch say of it: with S the covariance of
the innovations y, the i-th lies (S^-1 y)_i / (S^-1)_ii from there, with a variance of 1 / (S^-1)_ii
(data snooping; W. Baarda, A testing procedure for use in geodetic networks, 1968).
"""

import math
from typing import NamedTuple

import numpy as np

from wayline.tuning import Tuning
from wayline_fusion.filter.range_noise import range_stds_m
from wayline_fusion.filter.ranging import OTHER_SYSTEMS, RANGING_SIZE, RangingStates
from wayline_fusion.filter.sight import Sight
from wayline_fusion.filter.states import Floats, States
from wayline_fusion.intake.events import Ranges

S, R = States, RangingStates


class Lines(NamedTuple):
    """Linearised measurements of one kind, a row each."""

    rows: Floats
    """Which satellites of the epoch they are of."""
    y: Floats
    H: Floats
    stds: Floats


def offset_state(system: str) -> int | None:
    """Where a system's offset is; None of the one that the clock is held against."""
    return R.OFFSETS + OTHER_SYSTEMS.index(system) if system in OTHER_SYSTEMS else None


def pseudorange_lines(x: Floats, epoch: Ranges, sight: Sight, slow_std_m: float) -> Lines:
    """Ranges from the place of LATENCY ago, with the clock; a part of their error varies slowly."""
    east, north, up = sight.directions.T
    sin, cos = math.sin(x[S.HEADING]), math.cos(x[S.HEADING])
    speed_mps, latency_s = x[S.ODOMETER_SCALE] * x[S.WHEEL_SPEED], x[S.LATENCY]
    along = east * sin + north * cos
    H = np.zeros((len(east), RANGING_SIZE))
    H[:, S.EAST], H[:, S.NORTH], H[:, R.HEIGHT] = -east, -north, -up
    H[:, S.GPS_EAST], H[:, S.GPS_NORTH] = -slow_std_m * east, -slow_std_m * north
    H[:, R.CLOCK] = 1.0
    H[:, S.LATENCY] = along * speed_mps
    for row, system in enumerate(epoch.systems):
        offset = offset_state(system)
        if offset is not None:
            H[row, offset] = 1.0
    slow_m = slow_std_m * (east * x[S.GPS_EAST] + north * x[S.GPS_NORTH])
    clock_m = H[:, R.CLOCK :].copy()
    clock_m[:, R.HEIGHT - R.CLOCK] = 0.0
    expected_m = sight.ranges_m - slow_m + clock_m @ x[R.CLOCK :] + along * speed_mps * latency_s
    stds_m = range_stds_m(epoch.stds_m, up, epoch.cn0_dbhz)
    return Lines(np.arange(len(east)), epoch.pseudoranges_m - expected_m, H, stds_m)


def range_rate_lines(x: Floats, epoch: Ranges, sight: Sight, tuning: Tuning) -> Lines:
    """Of the satellites that tell one and whose motion is known."""
    rows = np.flatnonzero(np.isfinite(epoch.rates_mps) & np.isfinite(sight.range_rates_mps))
    east, north, _ = sight.directions[rows].T
    sin, cos = math.sin(x[S.HEADING]), math.cos(x[S.HEADING])
    wheels_mps, scale = x[S.WHEEL_SPEED], x[S.ODOMETER_SCALE]
    along = east * sin + north * cos
    H = np.zeros((len(rows), RANGING_SIZE))
    H[:, S.HEADING] = -(east * cos - north * sin) * scale * wheels_mps
    H[:, S.WHEEL_SPEED], H[:, S.ODOMETER_SCALE] = -along * scale, -along * wheels_mps
    H[:, R.CLOCK_DRIFT] = 1.0
    expected_mps = sight.range_rates_mps[rows] - along * scale * wheels_mps + x[R.CLOCK_DRIFT]
    stds_mps = np.fmax(epoch.rate_stds_mps[rows], tuning.range_rate_std_mps)
    return Lines(rows, epoch.rates_mps[rows] - expected_mps, H, stds_mps)


class Judged(NamedTuple):
    """Measurements of one epoch held against the filter and each other."""

    is_accepted: np.ndarray
    off: Floats
    """From what the filter and the others that are accepted say, in stds of that."""


def judged(y: Floats, covariance: Floats, limit: float) -> Judged:
    """Refuse the most unlikely one as long as one is over the limit (of the squared `off`)."""
    inverse = np.linalg.inv(covariance)
    is_accepted = np.ones(len(y), dtype=bool)
    off = np.zeros(len(y))
    while is_accepted.any():
        kept = np.flatnonzero(is_accepted)
        diagonal = inverse[kept, kept]
        off[kept] = (inverse[np.ix_(kept, kept)] @ y[kept]) / np.sqrt(diagonal)
        worst = kept[int(np.argmax(np.abs(off[kept])))]
        if off[worst] ** 2 <= limit:
            break
        is_accepted[worst] = False
        # without it the inverse is that of the covariance without its row and column
        inverse = inverse - np.outer(inverse[worst], inverse[worst]) / inverse[worst, worst]
    return Judged(is_accepted, off)
