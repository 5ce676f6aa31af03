"""Pure: how long a way is by where it begins and ends and the direction at both ends.

Two fixes have a chord (the straight line between them) and two turns: from the direction before
the first to the chord, and from the chord to the direction behind the second. The shortest way that
fits is a smooth curve, the longest a corner where the two directions meet; the truth lies between,
nearer to the curve.
"""

import math
from typing import NamedTuple

import numpy as np

from wayline.geo import Step, step_between, wrap_180
from wayline.trip_distance.track import Track

CHORD_STD_M = 2.5
"""Of the distance between two fixes: what their errors differ by within a minute."""
CORNER_SHARE = 0.25
"""Where between the curve and the corner the way is expected."""
CORNER_STD_SHARE = 0.5
SHARPEST_RAD = math.radians(150.0)
"""Directions that turn by more meet nowhere."""
UNKNOWN_TURN_STD_SHARE = 0.1
"""Of the chord, where a direction is unknown on one side."""
DIRECTION_MPS = 2.0
"""Slower than this a course is noise."""
DIRECTION_M = 15.0
"""Positions so far apart tell a direction."""
DIRECTION_S = 60.0
"""Before or behind; what was further away is forgotten."""


class Way(NamedTuple):
    """Between two fixes."""

    distance_m: float
    distance_std_m: float
    """One sigma."""


def way_by_shape(track: Track, begin: int, end: int) -> Way:
    """From one fix to another, by their places and the directions before and behind them."""
    step = _step(track, begin, end)
    before_deg, behind_deg = _direction_deg(track, begin, -1), _direction_deg(track, end, 1)
    if before_deg is None or behind_deg is None:
        spread_m = UNKNOWN_TURN_STD_SHARE * step.distance_m
        return Way(step.distance_m, math.hypot(CHORD_STD_M, spread_m))
    before_rad = math.radians(wrap_180(step.bearing_deg - before_deg))
    behind_rad = math.radians(wrap_180(behind_deg - step.bearing_deg))
    curve, corner = (
        curve_over_chord(before_rad, behind_rad),
        corner_over_chord(before_rad, behind_rad),
    )
    factor = curve + CORNER_SHARE * (corner - curve)
    spread_m = CORNER_STD_SHARE * (corner - 1.0) * step.distance_m
    return Way(factor * step.distance_m, math.hypot(CHORD_STD_M, spread_m))


def curve_over_chord(before_rad: float, behind_rad: float) -> float:
    """Of a circle's arc, or of two opposite bends; turns are positive to the right."""
    if before_rad * behind_rad < 0.0:
        return 1.0 + (2.0 * before_rad**2 + 2.0 * behind_rad**2 + before_rad * behind_rad) / 30.0
    half_rad = 0.5 * min(abs(before_rad) + abs(behind_rad), SHARPEST_RAD)
    return half_rad / math.sin(half_rad) if half_rad > 0.0 else 1.0


def corner_over_chord(before_rad: float, behind_rad: float) -> float:
    """Of the two sides that meet in a corner; of opposite bends, which meet in none, the curve."""
    total_rad = abs(before_rad) + abs(behind_rad)
    if before_rad * behind_rad <= 0.0:
        return curve_over_chord(before_rad, behind_rad)
    shrunk = min(1.0, SHARPEST_RAD / total_rad)
    before_rad, behind_rad = abs(before_rad) * shrunk, abs(behind_rad) * shrunk
    return (math.sin(before_rad) + math.sin(behind_rad)) / math.sin(before_rad + behind_rad)


def _direction_deg(track: Track, fix: int, way: int) -> float | None:
    """In which the vehicle drove there, by a fix and those before (way -1) or behind it (1)."""
    at = fix
    while 0 <= at < len(track) and abs(track.times_s[at] - track.times_s[fix]) <= DIRECTION_S:
        if track.speeds_mps[at] >= DIRECTION_MPS and not math.isnan(track.courses_deg[at]):
            return float(track.courses_deg[at])
        if np.linalg.norm(track.places_m[at] - track.places_m[fix]) >= DIRECTION_M:
            return _step(track, min(at, fix), max(at, fix)).bearing_deg
        at += way
    return None


def _step(track: Track, begin: int, end: int) -> Step:
    lats_deg, lons_deg = track.lats_deg, track.lons_deg
    return step_between(
        float(lats_deg[begin]), float(lons_deg[begin]), float(lats_deg[end]), float(lons_deg[end])
    )
