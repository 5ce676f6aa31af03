"""Pure: a directed line on the ground (a route, a road) measured in metres along it."""

from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wayline.geo import WGS84, metres_per_degree, wrap_360

Floats = NDArray[np.float64]


TURNED_DEG = 90.0
"""A place farther from a line's first vertex may be nearer the other way round the Earth."""


class Projection(NamedTuple):
    """The point of a line that lies nearest to a given point."""

    distance_m: float
    """Along the line from its start."""
    cross_track_m: float
    """Of the given point from the line, positive to the right of the direction of travel."""
    lat_deg: float
    lon_deg: float
    heading_deg: float
    """Of the line there."""


class Line:
    """Vertices joined by geodesics; `distances_m[i]` is the length of the line up to vertex i."""

    def __init__(self, lats_deg: Floats, lons_deg: Floats) -> None:
        self.lats_deg = np.asarray(lats_deg, dtype=np.float64)
        self.lons_deg = np.asarray(lons_deg, dtype=np.float64)
        if len(self.lats_deg) < 2 or len(self.lats_deg) != len(self.lons_deg):
            raise ValueError("a line needs two or more points")
        headings, _, legs = WGS84.inv(
            self.lons_deg[:-1], self.lats_deg[:-1], self.lons_deg[1:], self.lats_deg[1:]
        )
        self.legs_m: Floats = np.asarray(legs)
        self.headings_deg: Floats = np.asarray(headings) % 360.0
        self.distances_m: Floats = np.concatenate(([0.0], np.cumsum(self.legs_m)))

    @cached_property
    def _turned_lons_deg(self) -> Floats:
        """Longitudes of one turn with the first vertex's."""
        first_deg = self.lons_deg[0]
        return np.asarray((self.lons_deg - first_deg + 180.0) % 360.0 - 180.0 + first_deg)

    @property
    def length_m(self) -> float:
        """Length from the first vertex to the last."""
        return float(self.distances_m[-1])

    def point_at(self, distance_m: float) -> tuple[float, float, float]:
        """Latitude, longitude and heading in degrees at a distance, clipped to the line."""
        clipped = min(max(distance_m, 0.0), self.length_m)
        leg = self.leg_at(clipped)
        lon_deg, lat_deg, back_deg = WGS84.fwd(
            self.lons_deg[leg],
            self.lats_deg[leg],
            self.headings_deg[leg],
            clipped - self.distances_m[leg],
        )
        return float(lat_deg), float(lon_deg), wrap_360(float(back_deg) + 180.0)

    def points_at(self, distances_m: Floats) -> tuple[Floats, Floats, Floats]:
        """Latitudes, longitudes and headings as of `point_at`, shape (n,) each."""
        clipped = np.clip(distances_m, 0.0, self.length_m)
        legs = np.searchsorted(self.distances_m, clipped, side="right") - 1
        legs = np.clip(legs, 0, len(self.legs_m) - 1)
        lons_deg, lats_deg, backs_deg = WGS84.fwd(
            self.lons_deg[legs],
            self.lats_deg[legs],
            self.headings_deg[legs],
            clipped - self.distances_m[legs],
        )
        headings_deg = (np.asarray(backs_deg) + 180.0) % 360.0
        headings_deg[headings_deg == 360.0] = 0.0
        return np.asarray(lats_deg), np.asarray(lons_deg), headings_deg

    def leg_at(self, distance_m: float) -> int:
        """Index of the leg that holds a distance; at a vertex the one that begins there."""
        leg = int(self.distances_m.searchsorted(distance_m, side="right")) - 1
        return min(max(leg, 0), len(self.legs_m) - 1)

    def project(
        self,
        lat_deg: float,
        lon_deg: float,
        *,
        from_m: float = 0.0,
        to_m: float = float("inf"),
        heading_deg: float | None = None,
        heading_tolerance_deg: float = 90.0,
    ) -> Projection | None:
        """The nearest point, within a stretch and, if a heading is given, on legs that run its way.

        None where no leg qualifies.
        """
        nearest = self.project_legs(lat_deg, lon_deg, from_m=from_m, to_m=to_m)
        offsets_m = nearest.offsets_m
        if heading_deg is not None:
            turns = np.abs((self.headings_deg - heading_deg + 180.0) % 360.0 - 180.0)
            offsets_m = np.where(turns <= heading_tolerance_deg, offsets_m, np.inf)
        leg = int(np.argmin(offsets_m))
        if not np.isfinite(offsets_m[leg]):
            return None
        along_m = float(nearest.alongs_m[leg])
        at_lat_deg, at_lon_deg, _ = self.point_at(along_m)
        return Projection(
            along_m,
            float(np.copysign(offsets_m[leg], nearest.sides[leg])),
            at_lat_deg,
            at_lon_deg,
            float(self.headings_deg[leg]),
        )

    def project_legs(
        self, lat_deg: float, lon_deg: float, *, from_m: float = 0.0, to_m: float = float("inf")
    ) -> "LegProjections":
        """The nearest point of every leg; legs outside the stretch are infinitely far."""
        north_m_per_deg, east_m_per_deg = metres_per_degree(lat_deg)
        east_m = (self._turned_lons_deg - lon_deg) * east_m_per_deg
        if abs(self._turned_lons_deg[0] - lon_deg) > TURNED_DEG:
            east_m = ((self.lons_deg - lon_deg + 180.0) % 360.0 - 180.0) * east_m_per_deg
        north_m = (self.lats_deg - lat_deg) * north_m_per_deg
        leg_east, leg_north = east_m[1:] - east_m[:-1], north_m[1:] - north_m[:-1]
        squared = np.maximum(leg_east**2 + leg_north**2, 1e-12)
        share = -(east_m[:-1] * leg_east + north_m[:-1] * leg_north) / squared
        whole = from_m <= 0.0 and to_m >= self.length_m
        share = (
            np.minimum(np.maximum(share, 0.0), 1.0) if whole else self._clipped(share, from_m, to_m)
        )
        offset_east = east_m[:-1] + share * leg_east
        offset_north = north_m[:-1] + share * leg_north
        offsets_m = np.hypot(offset_east, offset_north)
        if not whole:
            outside = (self.distances_m[1:] < from_m) | (self.distances_m[:-1] > to_m)
            offsets_m = np.where(outside, np.inf, offsets_m)
        sides = leg_east * offset_north - leg_north * offset_east
        return LegProjections(self.distances_m[:-1] + share * self.legs_m, offsets_m, sides)

    def _clipped(self, shares: Floats, from_m: float, to_m: float) -> Floats:
        """Shares of the legs, within a stretch of the line."""
        lengths = np.maximum(self.legs_m, 1e-6)
        low = np.clip((from_m - self.distances_m[:-1]) / lengths, 0.0, 1.0)
        high = np.clip((to_m - self.distances_m[:-1]) / lengths, 0.0, 1.0)
        return np.asarray(np.clip(shares, low, high))


class LegProjections(NamedTuple):
    """Nearest points of every leg: distance along the line, distance away, side (> 0 right)."""

    alongs_m: Floats
    offsets_m: Floats
    sides: Floats
