"""Pure: a local plane whose origin moves along with the vehicle, so that it stays flat."""

import math
from typing import NamedTuple

from wayline.geo import LocalPlane

RADIUS_M = 1_000.0
"""Within this of the origin north is true to 0.02 degrees, up to latitude 60."""


class Moved(NamedTuple):
    """A new origin under the vehicle."""

    plane: LocalPlane
    turn_rad: float
    """What headings of the old plane gain in the new one, clockwise."""


def moved_along(plane: LocalPlane | None, east_m: float, north_m: float) -> Moved | None:
    """The plane to go on with at a place far from the origin; None near it."""
    if plane is None or math.hypot(east_m, north_m) < RADIUS_M:
        return None
    lat_deg, lon_deg = plane.to_geodetic(east_m, north_m)
    convergence_deg = (lon_deg - plane.lon_deg) * math.sin(math.radians(lat_deg))
    return Moved(LocalPlane(lat_deg, lon_deg), math.radians(convergence_deg))
