"""Pure: how far a vehicle went while no fix told it, by speed and direction on both sides.

The shape of the way (`shape`), as winding as the trip's other stretches are (`windings`), is one
answer. The speeds at both ends, and those of doubtful fixes between, times the time are another,
right for as long as the vehicle keeps driving. The two are weighed by what each may be off. Along a
route neither is needed.
"""

import math

import numpy as np

from wayline.line import Line
from wayline.trip_distance.integrated_walk import Flags, Floats
from wayline.trip_distance.shape import Way, way_by_shape
from wayline.trip_distance.track import Track
from wayline.trip_distance.trust import Hole
from wayline.trip_distance.windings import Windings

SPEED_STD_MPS_PER_SQRT_S = 0.5
"""Between two known speeds a vehicle's speed wanders by so much in a second."""
DOUBTFUL_SPEED_SHARE = 0.5
"""Of a doubtful fix's std of speed: what all of them in a hole have in common."""
WAITED_STD_SHARE = 0.5
"""Of what speeds say beyond the shape: a vehicle that waits is why they say too much."""
DETOUR_STD_SHARE = 0.15
"""Of the way that there was time for beyond the shape: most vehicles waited, some went round."""
DETOUR_CHORDS_MAX = 2.0
"""A longer detour is none that a std could tell of."""

BESIDE_ROUTE_M = 40.0
"""Fixes farther from a route than this do not follow it."""
ROUTE_STD_M = 5.0
ROUTE_STD_SHARE = 0.005
ROUTE_CHORDS_MAX = 4.0
"""A way along a route that is longer than this many chords is another pass of it."""


class Bridges:
    """Over the holes of one trip: its way by speeds alone, and a route where it follows one."""

    def __init__(
        self, track: Track, steps_m: Floats, believed: Flags, route: Line | None = None
    ) -> None:
        self._track = track
        self._ways_m = np.concatenate(([0.0], np.cumsum(steps_m)))
        self._windings = Windings(track, self._ways_m, believed)
        self._route = route

    def over(self, hole: Hole) -> Way:
        """From the fix at which it begins to the one at which it ends."""
        chord_m = self._track.chord_m(*hole)
        by_route = None if self._route is None else _along(self._route, self._track, hole)
        return by_route or self._by_shape_and_speed(hole, chord_m)

    def _by_shape_and_speed(self, hole: Hole, chord_m: float) -> Way:
        plain = way_by_shape(self._track, *hole)
        winding = self._windings.of(chord_m)
        speed_m, speed_std_m = self._by_speed(hole)
        waited_m = max(speed_m - plain.distance_m, 0.0)
        by_speed = Way(speed_m, math.hypot(speed_std_m, WAITED_STD_SHARE * waited_m))
        # no way is shorter than its chord, but where a reflection is at one end of it
        shortest_m = min(chord_m, speed_m + 2.0 * speed_std_m)
        by_shape = Way(
            plain.distance_m * (1.0 + winding.longer),
            math.hypot(plain.distance_std_m, winding.std * plain.distance_m),
        )
        way = weighed(by_shape, by_speed)
        detour_std_m = DETOUR_STD_SHARE * min(waited_m, DETOUR_CHORDS_MAX * chord_m)
        return Way(max(way.distance_m, shortest_m), math.hypot(way.distance_std_m, detour_std_m))

    def _by_speed(self, hole: Hole) -> Way:
        steps_s = self._track.steps_s[hole.begin : hole.end]
        told_mps = self._track.speed_stds_mps[hole.begin : hole.end + 1]
        between_m = SPEED_STD_MPS_PER_SQRT_S * math.sqrt(float(np.sum(steps_s**3)) / 12.0)
        alike_m = DOUBTFUL_SPEED_SHARE * float(np.median(told_mps) * np.sum(steps_s))
        way_m = float(self._ways_m[hole.end] - self._ways_m[hole.begin])
        return Way(way_m, math.hypot(between_m, alike_m))


def weighed(one: Way, other: Way) -> Way:
    """Their mean by variances; what they differ by is part of its std."""
    share = other.distance_std_m**2 / (one.distance_std_m**2 + other.distance_std_m**2)
    mean_m = share * one.distance_m + (1.0 - share) * other.distance_m
    apart_m2 = share * (1.0 - share) * (one.distance_m - other.distance_m) ** 2
    return Way(mean_m, math.sqrt(share * one.distance_std_m**2 + apart_m2))


def _along(route: Line, track: Track, hole: Hole) -> Way | None:
    """The way along a route; None where the ends do not lie on it, one behind the other."""
    begin, end = (
        route.project(float(track.lats_deg[fix]), float(track.lons_deg[fix])) for fix in hole
    )
    if begin is None or end is None:
        return None
    if max(abs(begin.cross_track_m), abs(end.cross_track_m)) > BESIDE_ROUTE_M:
        return None
    way_m, chord_m = end.distance_m - begin.distance_m, track.chord_m(*hole)
    if not chord_m - BESIDE_ROUTE_M <= way_m <= ROUTE_CHORDS_MAX * chord_m:
        return None
    return Way(max(way_m, chord_m), math.hypot(ROUTE_STD_M, ROUTE_STD_SHARE * way_m))
