"""Pure: the speed over a trip, smoothed: the receiver's own where it can be believed.

Doppler measures speed apart from position (papers/003), so its errors come out of a sum of speeds,
where those of positions only add to a sum of steps. Where a receiver tells no speed, or one in
another unit, positions are smoothed instead and their rates of change taken.
"""

from typing import Literal, NamedTuple

import numpy as np

from wayline.trip_distance.integrated_walk import Floats, smoothed
from wayline.trip_distance.standing import stands
from wayline.trip_distance.track import Track
from wayline.trip_distance.trust import (
    ACCELERATION_MPS_PER_SQRT_S,
    BAD_POSITION_STD_M,
    HOLE_S,
    POSITION_STD_M,
)

Basis = Literal["speeds", "positions"]

JERK_MPS2_PER_SQRT_S = 1.0
"""Within a second an acceleration changes by so much: brakes and gears."""
CREEPING_SHARE = 0.5
"""Of the way that is left out as noise at rest: it may all have been one, says two sigma."""
STANDING_BY_POSITIONS_MPS = 0.5
"""Positions at rest wander by less."""
TOLD_SHARE_MIN = 0.5
"""With fewer fixes that tell a speed, positions say more."""

COMPARED_S = 10.0
"""Over this time positions tell a mean speed to a tenth of a metre a second."""
COMPARED_MPS = 4.0
"""Slower than this the wander of positions is too much of it."""
COMPARED_MIN = 5
UNIT_TOLERANCE = 0.15
"""Of the ratio of positions to speeds; what is further off is another unit."""
UNITS = {0.514444: "knots", 0.44704: "mph", 0.277778: "km/h"}
"""What a number in this unit is in m/s."""


class UnitDoubt(NamedTuple):
    """Speeds that are not in m/s."""

    times: float
    """They are so many times what positions say."""
    unit: str | None
    """What they seem to be in; None: nothing known."""
    scale: float
    """Times this they are in m/s."""

    def __str__(self) -> str:
        said = f"speeds are {self.times:.2f} times what positions say"
        return said if self.unit is None else f"{said}: {self.unit} taken as m/s"


class Profile(NamedTuple):
    """Speeds at the fixes of a track, 0 where the vehicle stands."""

    speeds_mps: Floats
    basis: Basis
    white_std_m: float
    """One sigma of their sum over time, by what a single one may be off."""
    doubts: tuple[str, ...]


def profile_of(track: Track) -> Profile:
    """The speed over a trip of two fixes or more."""
    told = ~np.isnan(track.speeds_mps)
    if np.mean(told) < TOLD_SHARE_MIN:
        return _by_positions(track, ())
    if doubt := unit_doubt(track):
        return _by_positions(track, (str(doubt),))
    made = smoothed(track.times_s, track.speeds_mps, track.speed_stds_mps, JERK_MPS2_PER_SQRT_S)
    still = stands(track, made.values)
    spans_s = _spans_s(track)
    creeping_m = CREEPING_SHARE * float(np.abs(made.values) @ np.where(still, spans_s, 0.0))
    std_m = float(np.hypot(made.std_of_sum(spans_s), creeping_m))
    return Profile(np.where(still, 0.0, made.values), "speeds", std_m, ())


def _by_positions(track: Track, doubts: tuple[str, ...]) -> Profile:
    # where all are bad, they are all that there is
    believed = track.good if track.good.any() else ~track.good
    stds_m = np.where(believed, POSITION_STD_M, BAD_POSITION_STD_M)
    made = smoothed(track.times_s, track.places_m, stds_m, ACCELERATION_MPS_PER_SQRT_S)
    speeds_mps = np.hypot(*made.rates.T)
    # a sum of steps knows its ends only; each start from rest adds what positions wander
    return Profile(
        np.where(speeds_mps < STANDING_BY_POSITIONS_MPS, 0.0, speeds_mps),
        "positions",
        POSITION_STD_M * np.sqrt(0.1 * len(track)),
        doubts,
    )


def _spans_s(track: Track) -> Floats:
    """For how long each speed counts in a sum by trapezoids that leaves out the holes."""
    halves_s = np.where(track.steps_s > HOLE_S, 0.0, 0.5 * track.steps_s)
    spans_s: Floats = np.concatenate((halves_s, [0.0])) + np.concatenate(([0.0], halves_s))
    return spans_s


def positions_over_speeds(track: Track) -> float | None:
    """Median ratio of the way between positions 10 s apart to the way by speeds; None if unknown.

    About 1 where speeds are in m/s; 0.51 where they are knots that were taken as m/s.
    """
    begins = np.arange(len(track))
    ends = np.searchsorted(track.times_s, track.times_s + COMPARED_S)
    inside = ends < len(track)
    begins, ends = begins[inside], ends[inside]
    doubtful = (track.steps_s > HOLE_S) | ~(track.good[1:] & track.good[:-1])
    doubts = np.concatenate(([0], np.cumsum(doubtful)))
    told_m = _added_up(track.speeds_mps, track.steps_s)
    ways_m = np.concatenate(([0.0], np.cumsum(track.chords_m)))
    way_m, by_speed_m = ways_m[ends] - ways_m[begins], told_m[ends] - told_m[begins]
    apart_m = np.linalg.norm(track.places_m[ends] - track.places_m[begins], axis=1)
    taken_s = track.times_s[ends] - track.times_s[begins]
    # a straight way only: its length is known by its ends
    clear = (doubts[ends] == doubts[begins]) & (apart_m > COMPARED_MPS * taken_s)
    clear &= (apart_m > 0.95 * way_m) & (by_speed_m > 0.0)
    if clear.sum() < COMPARED_MIN:
        return None
    return float(np.median(apart_m[clear] / by_speed_m[clear]))


def _added_up(speeds_mps: Floats, steps_s: Floats) -> Floats:
    steps_m = 0.5 * (speeds_mps[1:] + speeds_mps[:-1]) * steps_s
    added: Floats = np.concatenate(([0.0], np.cumsum(np.nan_to_num(steps_m))))
    return added


def unit_doubt(track: Track) -> UnitDoubt | None:
    """What told speeds may be in that are far from what positions say; None where they agree."""
    ratio = positions_over_speeds(track)
    if ratio is None or abs(np.log(ratio)) <= UNIT_TOLERANCE:
        return None
    unit, name = min(UNITS.items(), key=lambda each: abs(np.log(each[0] / ratio)))
    is_known = abs(np.log(unit / ratio)) < UNIT_TOLERANCE
    return UnitDoubt(1.0 / ratio, name if is_known else None, unit if is_known else ratio)
