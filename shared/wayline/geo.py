"""Pure: geodesy on WGS84, by pyproj's geodesics."""

import math
from typing import NamedTuple

from pyproj import Geod

WGS84 = Geod(ellps="WGS84")
POLE_DEG = 89.999
"""Nearer to a pole degrees of longitude have no length to speak of, and latitudes end."""


def wrap_360(angle_deg: float) -> float:
    """An angle in 0 <= x < 360."""
    wrapped = angle_deg % 360.0
    return 0.0 if wrapped == 360.0 else wrapped


def wrap_180(angle_deg: float) -> float:
    """An angle in -180 <= x < 180."""
    return (angle_deg + 180.0) % 360.0 - 180.0


def wrap_pi(angle_rad: float) -> float:
    """An angle in -pi <= x < pi."""
    return (angle_rad + math.pi) % (2.0 * math.pi) - math.pi


class Step(NamedTuple):
    """The geodesic from one point to another."""

    distance_m: float
    bearing_deg: float
    """At the first point, 0 <= x < 360."""


def step_between(lat1_deg: float, lon1_deg: float, lat2_deg: float, lon2_deg: float) -> Step:
    """Length and first bearing of the geodesic between two points."""
    azimuth_deg, _, distance_m = WGS84.inv(lon1_deg, lat1_deg, lon2_deg, lat2_deg)
    return Step(float(distance_m), wrap_360(float(azimuth_deg)))


def metres_per_degree(lat_deg: float) -> tuple[float, float]:
    """Metres per degree of latitude and of longitude at a latitude; at a pole, those beside it."""
    lat_deg = min(max(lat_deg, -POLE_DEG), POLE_DEG)
    _, _, north_m = WGS84.inv(0.0, lat_deg - 5e-4, 0.0, lat_deg + 5e-4)
    _, _, east_m = WGS84.inv(0.0, lat_deg, 1e-3, lat_deg)
    return float(north_m) * 1e3, float(east_m) * 1e3


class LocalPlane(NamedTuple):
    """Metres east and north of an origin, azimuthal equidistant.

    Distance and bearing from the origin are exact; within 2 km of it lengths are right to 1e-7
    and north is true to 0.03 degrees at latitude 60, so a long drive moves its origin along.
    """

    lat_deg: float
    lon_deg: float

    def to_plane(self, lat_deg: float, lon_deg: float) -> tuple[float, float]:
        """East and north in metres of a point in degrees."""
        azimuth_deg, _, distance_m = WGS84.inv(self.lon_deg, self.lat_deg, lon_deg, lat_deg)
        azimuth_rad = math.radians(azimuth_deg)
        return distance_m * math.sin(azimuth_rad), distance_m * math.cos(azimuth_rad)

    def to_geodetic(self, east_m: float, north_m: float) -> tuple[float, float]:
        """Latitude and longitude in degrees of a point in metres."""
        azimuth_deg = math.degrees(math.atan2(east_m, north_m))
        distance_m = math.hypot(east_m, north_m)
        lon_deg, lat_deg, _ = WGS84.fwd(self.lon_deg, self.lat_deg, azimuth_deg, distance_m)
        return float(lat_deg), float(lon_deg)
