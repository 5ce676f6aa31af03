"""Pure: how much longer the roads of a trip are than their ends tell, by the trip itself.

A trip through a grid of streets turns corners of which the two ends of a hole know nothing; one on
a main road hardly any. Stretches of the trip that GPS did see, as long as the hole is, tell which.
"""

from functools import cache
from typing import NamedTuple

import numpy as np

from wayline.trip_distance.integrated_walk import Flags, Floats
from wayline.trip_distance.shape import way_by_shape
from wayline.trip_distance.track import Track
from wayline.trip_distance.trust import HOLE_S

SHORTEST_M = 50.0
"""Of a stretch that is looked at."""
STRETCHES_MAX = 40
"""So many tell as much as all."""
STRETCHES_MIN = 12
"""With fewer, nothing is known but what roads are like."""
LONGER_MAX = 1.5
"""Share of a stretch; a way that is still longer went there and back."""
LONGEST_CHORDS = 5.0
UNKNOWN_STD = 0.05
STD_MIN = 0.01


class Winding(NamedTuple):
    """What a way is longer than by its shape, as a share of it."""

    longer: float
    std: float


class Windings:
    """Of one trip, at ways of one length and another.

    `ways_m` is the way up to each fix by speeds, `believed` are fixes whose positions are.
    """

    def __init__(self, track: Track, ways_m: Floats, believed: Flags) -> None:
        self._track = track
        self._ways_m = ways_m
        self._believed = believed
        told = track.good[1:] & track.good[:-1] & (track.steps_s <= HOLE_S)
        self._silences = np.concatenate(([0], np.cumsum(~told)))
        self._of_octave = cache(self._found)

    def of(self, chord_m: float) -> Winding:
        """Of ways whose ends are so far apart."""
        return self._of_octave(round(np.log2(max(chord_m, SHORTEST_M))))

    def _found(self, octave: int) -> Winding:
        chord_m = 2.0**octave
        begins = np.unique(np.linspace(0, len(self._track) - 1, STRETCHES_MAX).astype(int))
        ends = [self._end_of(int(begin), chord_m) for begin in begins]
        longer = [
            self._longer(int(begin), end)
            for begin, end in zip(begins, ends, strict=True)
            if end is not None
        ]
        if len(longer) < STRETCHES_MIN:
            return Winding(0.0, UNKNOWN_STD)
        middle = float(np.median(longer))
        spread = float(np.sqrt(np.mean(np.square(np.minimum(longer, LONGER_MAX) - middle))))
        return Winding(max(middle, 0.0), max(spread, STD_MIN))

    def _end_of(self, begin: int, chord_m: float) -> int | None:
        """The first fix so far away from another, unless a hole or a long way lies between."""
        way_m = self._ways_m[begin]
        first, last = np.searchsorted(
            self._ways_m, [way_m + 0.9 * chord_m, way_m + LONGEST_CHORDS * chord_m]
        )
        places_m = self._track.places_m
        apart_m = np.linalg.norm(places_m[first:last] - places_m[begin], axis=1)
        far = np.flatnonzero(apart_m >= chord_m)
        if not len(far):
            return None
        end = int(first + far[0])
        is_told = self._silences[end] == self._silences[begin]
        return end if is_told and self._believed[[begin, end]].all() else None

    def _longer(self, begin: int, end: int) -> float:
        way_m = float(self._ways_m[end] - self._ways_m[begin])
        return way_m / way_by_shape(self._track, begin, end).distance_m - 1.0
