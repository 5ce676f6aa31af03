"""Pure: where a satellite stands in a receiver's sky."""

import math
from typing import NamedTuple

from pyproj import Transformer

from wayline.satellites.earth import Vector

TO_GEODETIC = Transformer.from_crs("EPSG:4978", "EPSG:4979", always_xy=True)


class Horizon(NamedTuple):
    """A place on the earth, and the directions that are east, north and up there."""

    place_m: Vector
    lat_deg: float
    lon_deg: float
    height_m: float
    """Above the ellipsoid."""

    @classmethod
    def of(cls, place_m: Vector) -> "Horizon":
        """The horizon of a place told in ECEF."""
        lon_deg, lat_deg, height_m = TO_GEODETIC.transform(*place_m)
        return cls(place_m, float(lat_deg), float(lon_deg), float(height_m))

    def direction_deg(self, satellite_m: Vector) -> tuple[float, float]:
        """Elevation and azimuth (clockwise from north, 0 <= x < 360) of a satellite in ECEF."""
        x, y, z = satellite_m.moved(self.place_m, -1.0)
        lat, lon = math.radians(self.lat_deg), math.radians(self.lon_deg)
        outward = math.cos(lon) * x + math.sin(lon) * y
        east = math.cos(lon) * y - math.sin(lon) * x
        north = math.cos(lat) * z - math.sin(lat) * outward
        up = math.sin(lat) * z + math.cos(lat) * outward
        elevation_deg = math.degrees(math.atan2(up, math.hypot(east, north)))
        return elevation_deg, math.degrees(math.atan2(east, north)) % 360.0
