"""Pure: the fixes of a trip whose positions can be believed, and the holes between them.

A receiver that sees too few satellites says where it may be, off by metres or by hundreds of
kilometres (papers/003 gives such fixes a noise of 690 miles), and a reflection says so in good
conscience. Of both the speed may still be right; a chord must not begin or end there.
"""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from wayline.trip_distance.integrated_walk import Flags, smoothed
from wayline.trip_distance.track import Track

HOLE_S = 3.0
"""Over a longer time speeds at both ends no longer tell how far the vehicle came."""
POSITION_STD_M = 1.0
"""Of a fix against its neighbours: the part of its error that does not wander slowly."""
BAD_POSITION_STD_M = 1e3
"""A fix of few satellites or a poor PDOP tells next to nothing."""
ACCELERATION_MPS_PER_SQRT_S = 1.5
"""Within a second a velocity changes by so much, either way: turns, brakes."""
TRUSTED_WEIGHT = 0.1
"""Below it a position is nine stds from what its neighbours say."""


class Hole(NamedTuple):
    """From one trusted fix to the next, with none or only doubtful ones between."""

    begin: int
    end: int


def trusted(track: Track) -> Flags:
    """Good fixes that agree with their neighbours, shape (n,); all, where there is no good one."""
    if not track.good.any():
        return np.ones(len(track), dtype=bool)
    stds_m = np.where(track.good, POSITION_STD_M, BAD_POSITION_STD_M)
    made = smoothed(track.times_s, track.places_m, stds_m, ACCELERATION_MPS_PER_SQRT_S)
    believed = track.good & (made.weights >= TRUSTED_WEIGHT)
    return believed if believed.any() else track.good


def holes_between(track: Track, believed: Flags) -> Iterator[Hole]:
    """Where no trusted fix came for longer than speeds can span."""
    fixes = np.flatnonzero(believed)
    for at in np.flatnonzero(np.diff(track.times_s[fixes]) > HOLE_S):
        yield Hole(int(fixes[at]), int(fixes[at + 1]))
