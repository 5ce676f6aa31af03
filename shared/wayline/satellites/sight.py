"""Pure: how satellites are seen from a place on the ground, by vectors."""

import math
from typing import NamedTuple

import numpy as np
from pyproj import Transformer

from wayline.likelihood import Floats
from wayline.satellites.earth import EARTH_RATE_RADPS, SPEED_OF_LIGHT_MPS

TO_ECEF = Transformer.from_crs("EPSG:4979", "EPSG:4978", always_xy=True)


class Ground(NamedTuple):
    """A place with its directions."""

    place_m: Floats
    """Earth-centred, Earth-fixed; shape (3,)."""
    axes: Floats
    """Rows point east, north and up; shape (3, 3)."""


class Sight(NamedTuple):
    """Satellites from one place, a row each."""

    ranges_m: Floats
    """Geometric distance, from where each was at transmission to the place at reception."""
    directions: Floats
    """Unit vectors to them, east, north and up; shape (n, 3)."""
    range_rates_mps: Floats
    """As a place at rest sees them; nan of one whose motion is not known."""


def ground_at(lat_deg: float, lon_deg: float, height_m: float) -> Ground:
    """At a height above the WGS84 ellipsoid."""
    lat_rad, lon_rad = math.radians(lat_deg), math.radians(lon_deg)
    sin_lat, cos_lat = math.sin(lat_rad), math.cos(lat_rad)
    sin_lon, cos_lon = math.sin(lon_rad), math.cos(lon_rad)
    axes = [
        [-sin_lon, cos_lon, 0.0],
        [-sin_lat * cos_lon, -sin_lat * sin_lon, cos_lat],
        [cos_lat * cos_lon, cos_lat * sin_lon, sin_lat],
    ]
    place_m = TO_ECEF.transform(lon_deg, lat_deg, height_m)
    return Ground(np.array(place_m), np.array(axes))


def seen_from(ground: Ground, places_m: Floats, motions_mps: Floats) -> Sight:
    """Satellites whose places and motions, shape (n, 3), are in the frame of their transmission.

    While the signal travels the Earth turns under it (Sagnac effect): the satellite is turned back
    into the frame of the reception.
    """
    travelled_s = np.linalg.norm(places_m - ground.place_m, axis=1) / SPEED_OF_LIGHT_MPS
    turned_rad = EARTH_RATE_RADPS * travelled_s
    lines_m = _turned(places_m, turned_rad) - ground.place_m
    ranges_m = np.linalg.norm(lines_m, axis=1)
    lines_m /= ranges_m[:, None]
    rates_mps = np.sum(lines_m * _turned(motions_mps, turned_rad), axis=1)
    return Sight(ranges_m, lines_m @ ground.axes.T, rates_mps)


def _turned(vectors: Floats, angles_rad: Floats) -> Floats:
    """About the Earth's axis, each by its small angle, against the Earth's turn."""
    sin, cos = np.sin(angles_rad), np.cos(angles_rad)
    x, y, z = vectors.T
    return np.column_stack((cos * x + sin * y, cos * y - sin * x, z))
