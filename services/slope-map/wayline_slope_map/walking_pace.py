"""Pure: where a run went at a walking pace: car parks, yards and queues, which teach no road.

Torque says nothing there, walls hide the sky, and ramps are steeper than roads: what is smoothed of
it is sure of itself and wrong. The road beside it bears part of that error.
"""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from wayline.line import Floats
from wayline_slope_map.track import Track

WALKING_MPS = 5.0
LONGEST_M = 100.0
"""Stops and bends take less of a road at such a pace."""
BESIDE_M = 100.0
"""A ramp's slope is smeared over so much of the road before and after."""
PACE_OVER_M = 20.0
"""Over which a pace is taken: a gap of a second in the poses makes none."""


def is_driven(track: Track, travelled_m: Floats) -> NDArray[np.bool_]:
    """Whether a run teaches the road at distances travelled, shape (n,)."""
    driven = np.ones(len(travelled_m), dtype=np.bool_)
    for from_m, to_m in walked(track):
        driven &= (travelled_m < from_m) | (travelled_m > to_m)
    return driven


def walked(track: Track) -> Iterator[tuple[float, float]]:
    """From where to where a run teaches no road, in distances travelled; they may overlap."""
    at_m = np.arange(track.travelled_m[0], track.travelled_m[-1], PACE_OVER_M)
    took_s = np.diff(track.seconds_at(at_m))
    is_slow = took_s > PACE_OVER_M / WALKING_MPS
    edges = np.flatnonzero(np.diff(is_slow, prepend=False, append=False))
    for first, last in zip(edges[::2], edges[1::2], strict=True):
        if at_m[last] - at_m[first] > LONGEST_M:
            yield at_m[first] - BESIDE_M, at_m[last] + BESIDE_M
