"""Pure: when runs of one road passed the same points of it, by their places alone.

For drives without a truth, and for a reference that is a table of places: the road is the way of
the first run, its points are looked for among the places of the others that head the same way.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from wayline.geo import metres_per_degree
from wayline_evaluation.estimates import Estimates, Floats

NEAR_M = 30.0
"""A place farther from a point is none of this road."""
HEADING_M = 30.0
"""What a turn of a radian counts for beside metres: by NEAR_M alone no way turns 60 degrees."""
MOVING_MPS = 1.0
"""Slower, a place says nothing of the instant at which a point was passed."""


Rows = NDArray[np.intp]


class Places(NamedTuple):
    """Places with the direction of travel there, shape (n,) each; headings may be nan."""

    lats_deg: Floats
    lons_deg: Floats
    headings_deg: Floats


def points_along(estimates: Estimates, spacing_m: float) -> tuple[Floats, Places]:
    """Distances from the start of a run's way, `spacing_m` apart, and the places there."""
    rows = _moving(estimates)
    way_m = estimates.distances_m[rows]
    distances_m = np.arange(float(way_m[0]) + spacing_m, float(way_m[-1]), spacing_m)
    at = estimates.at(np.interp(distances_m, way_m, estimates.times_s[rows]))
    return distances_m - float(way_m[0]), Places(at.lats_deg, at.lons_deg, at.headings_deg)


def passed_s(estimates: Estimates, points: Places) -> Floats:
    """When a run passed each point, Unix; nan where it never came near on the same way."""
    rows = _moving(estimates)
    passing = estimates.at(estimates.times_s[rows])
    places = Places(passing.lats_deg, passing.lons_deg, passing.headings_deg)
    nearest, is_near = nearest_to(points, places)
    found = np.where(is_near, nearest, 0)
    ahead_m = _ahead_m(points, places, found)
    times_s = passing.times_s[found] + ahead_m / np.abs(passing.speeds_mps[found])
    return np.where(is_near, times_s, np.nan)


def nearest_to(points: Places, places: Places) -> tuple[Rows, NDArray[np.bool_]]:
    """For each point the row of the place next to it that heads alike, and whether it is near.

    Where a heading is unknown, on either side, places alone decide.
    """
    has_headings = bool(np.isfinite(points.headings_deg).all())
    has_headings &= bool(np.isfinite(places.headings_deg).all())
    origin = float(points.lats_deg[0]), float(points.lons_deg[0])
    tree = cKDTree(_features(places, origin, with_headings=has_headings))
    asked = _features(points, origin, with_headings=has_headings)
    apart_m, rows = tree.query(asked, distance_upper_bound=NEAR_M)
    return rows, np.isfinite(apart_m)


def _moving(estimates: Estimates) -> Rows:
    """Rows in order of the way, each farther along than all before it."""
    fast = np.abs(np.nan_to_num(estimates.speeds_mps)) > MOVING_MPS
    rows = np.flatnonzero(fast & np.isfinite(estimates.lats_deg))
    way_m = estimates.distances_m[rows]
    return rows[np.diff(np.maximum.accumulate(way_m), prepend=-np.inf) > 0.0]


def _features(places: Places, origin: tuple[float, float], *, with_headings: bool) -> Floats:
    north_m_per_deg, east_m_per_deg = metres_per_degree(origin[0])
    columns = [
        (places.lats_deg - origin[0]) * north_m_per_deg,
        (places.lons_deg - origin[1]) * east_m_per_deg,
    ]
    if with_headings:
        headings_rad = np.radians(places.headings_deg)
        columns += [HEADING_M * np.sin(headings_rad), HEADING_M * np.cos(headings_rad)]
    return np.column_stack(columns)


def _ahead_m(points: Places, places: Places, rows: Rows) -> Floats:
    """How far points lie ahead of places, along the places' headings."""
    north_m_per_deg, east_m_per_deg = metres_per_degree(float(points.lats_deg[0]))
    north_m = (points.lats_deg - places.lats_deg[rows]) * north_m_per_deg
    east_m = (points.lons_deg - places.lons_deg[rows]) * east_m_per_deg
    headings_rad = np.radians(places.headings_deg[rows])
    return np.asarray(north_m * np.cos(headings_rad) + east_m * np.sin(headings_rad))
