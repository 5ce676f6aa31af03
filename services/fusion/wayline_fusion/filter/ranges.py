"""Pure: what pseudoranges and range rates measure of the state, linearised at it."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wayline.messages import Verdict
from wayline.satellites.earth import SPEED_OF_LIGHT_MPS
from wayline.satellites.range_noise import Signals, one_sided, two_sided
from wayline.satellites.sight import Ground, Sight, seen_from
from wayline.snooping import Judged
from wayline.tuning import Tuning
from wayline_fusion.filter.gate import TOO_FAR
from wayline_fusion.filter.ranging import OTHER_SYSTEMS, RangingStates
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


def lines_of(x: Floats, epoch: Ranges, ground: Ground, turn_radps: float, tuning: Tuning) -> Lines:
    """Of a state, whose place is the ground, of a vehicle that turns clockwise so fast."""
    sight = seen_from(ground, epoch.places_m, epoch.motions_mps)
    ranges = _ranges(x, epoch, sight, tuning)
    rates = _range_rates(x, epoch, sight, turn_radps, tuning)
    is_range = np.arange(len(ranges.rows) + len(rates.rows)) < len(ranges.rows)
    return Lines(
        (
            *(f"gps_raw {epoch.names[row]}" for row in ranges.rows),
            *(f"gps_raw_rate {epoch.names[row]}" for row in rates.rows),
        ),
        np.concatenate((ranges.rows, rates.rows)),
        is_range,
        np.concatenate((ranges.y, rates.y)),
        np.vstack((ranges.H, rates.H)),
        np.concatenate((ranges.stds, rates.stds)),
    )


class _Kind(NamedTuple):
    """Of one kind; `rows` are those of the epoch."""

    rows: NDArray[np.int64]
    y: Floats
    H: Floats
    stds: Floats


def offset_state(system: str) -> int | None:
    """Where a system's offset is; None of the one that the clock is held against."""
    return R.OFFSETS + OTHER_SYSTEMS.index(system) if system in OTHER_SYSTEMS else None


def _ranges(x: Floats, epoch: Ranges, sight: Sight, tuning: Tuning) -> _Kind:
    """From the place of LATENCY ago, with the clock.

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
    stds_m = Signals(epoch.stds_m, up, epoch.cn0_dbhz).stds_m(tuning.range_std_floor_m)
    return _Kind(np.arange(len(y)), y, H, stds_m)


def _range_rates(
    x: Floats, epoch: Ranges, sight: Sight, turn_radps: float, tuning: Tuning
) -> _Kind:
    """Of the satellites that tell one and whose motion is known, with the heading of LATENCY ago.

    In a turn the antenna moves to the side of where the rear axle goes, and what its time is off by
    turns the way that it takes.
    """
    rows = np.flatnonzero(np.isfinite(epoch.rates_mps) & np.isfinite(sight.range_rates_mps))
    east, north, up = sight.directions[rows].T
    heading_rad = x[S.HEADING] - turn_radps * x[S.LATENCY]
    sin, cos = math.sin(heading_rad), math.cos(heading_rad)
    wheels_mps, scale = x[S.WHEEL_SPEED], x[S.ODOMETER_SCALE]
    along = east * sin + north * cos + up * x[R.SLOPE]
    H = np.zeros((len(rows), len(x)))
    speed_mps = scale * wheels_mps
    H[:, S.HEADING] = -(east * cos - north * sin) * speed_mps
    H[:, S.LATENCY] = -turn_radps * H[:, S.HEADING]
    H[:, S.WHEEL_SPEED], H[:, S.ODOMETER_SCALE] = -along * scale, -along * wheels_mps
    H[:, R.SLOPE], H[:, R.CLOCK_DRIFT] = -up * speed_mps, 1.0
    expected_mps = sight.range_rates_mps[rows] - along * speed_mps + x[R.CLOCK_DRIFT]
    aside_mps = turn_radps * (tuning.antenna_lever_m + abs(speed_mps) * tuning.gps_time_std_s)
    stds_mps = np.hypot(
        np.fmax(epoch.rate_stds_mps[rows], tuning.range_rate_std_floor_mps), aside_mps
    )
    return _Kind(rows, epoch.rates_mps[rows] - expected_mps, H, stds_mps)


def verdicts_of(lines: Lines, found: Judged, t_ns: int, limit: float) -> list[Verdict]:
    """One for each range and range rate."""
    return [
        Verdict(
            sensor=name,
            t_ns=t_ns,
            accepted=is_accepted,
            nis=off**2,
            threshold=limit,
            reason=None if is_accepted else TOO_FAR,
        )
        for name, is_accepted, off in zip(
            lines.names, found.is_accepted.tolist(), found.off.tolist(), strict=True
        )
    ]


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
