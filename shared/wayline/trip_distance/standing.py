"""Pure: when a vehicle stands though its speeds say a little: noise of Doppler at rest, no way."""

from collections.abc import Iterator

import numpy as np

from wayline.trip_distance.integrated_walk import Flags, Floats
from wayline.trip_distance.track import Track

STANDING_MPS = 0.2
"""Doppler of a good receiver at rest reads less."""
SLOW_MPS = 0.8
"""Doppler of a poor one at rest reads less; so does a vehicle that creeps."""
STAND_S = 30.0
"""So long slow, what positions moved tells the two apart."""
MOVED_SHARE = 0.3
"""Of the way by speeds: a vehicle that creeps moves by all of it."""
ENDS = 3
"""Fixes at both ends of a stand, whose median is where it was."""


def stands(track: Track, speeds_mps: Floats) -> Flags:
    """At each fix, by smoothed speeds and by what positions moved while they were low."""
    still = speeds_mps < STANDING_MPS
    for begin, end in _runs(speeds_mps < SLOW_MPS):
        inside = slice(begin, end)
        times_s, places_m = track.times_s[inside], track.places_m[inside]
        if times_s[-1] - times_s[0] < STAND_S:
            continue
        by_speeds_m = float(np.trapezoid(speeds_mps[inside], times_s))
        ends_m = np.median(places_m[:ENDS], axis=0) - np.median(places_m[-ENDS:], axis=0)
        if np.linalg.norm(ends_m) < MOVED_SHARE * by_speeds_m:
            still[inside] = True
    return still


def _runs(flags: Flags) -> Iterator[tuple[int, int]]:
    """Begin and end of each run of flags, the end behind it."""
    edges = np.flatnonzero(np.diff(flags.astype(np.int8), prepend=0, append=0))
    yield from zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True)
