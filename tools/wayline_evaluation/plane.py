"""Pure: a flat grid under a whole drive, on which a straight line stays straight."""

from dataclasses import dataclass

import numpy as np
from pyproj import Proj

from wayline_evaluation.estimates import Floats


@dataclass(frozen=True, slots=True)
class Grid:
    """Transverse Mercator about a point.

    Within 40 km of its meridian lengths are right to 2e-5, and a gyro's turn is the grid
    heading's to well below its noise.
    """

    lat_deg: float
    lon_deg: float

    def to_grid(self, lats_deg: Floats, lons_deg: Floats) -> tuple[Floats, Floats]:
        """East and north in metres."""
        east_m, north_m = self._projection()(lons_deg, lats_deg)
        return np.asarray(east_m), np.asarray(north_m)

    def to_geodetic(self, east_m: Floats, north_m: Floats) -> tuple[Floats, Floats]:
        """Latitudes and longitudes in degrees; nan stays nan."""
        known = ~np.isnan(east_m)
        lats_deg, lons_deg = np.full((2, len(east_m)), np.nan)
        lons_deg[known], lats_deg[known] = self._projection()(
            east_m[known], north_m[known], inverse=True
        )
        return lats_deg, lons_deg

    def convergence_deg(self, lats_deg: Floats, lons_deg: Floats) -> Floats:
        """What a grid heading lacks to a true one."""
        known = ~np.isnan(lats_deg)
        convergence = np.full(len(lats_deg), np.nan)
        factors = self._projection().get_factors(lons_deg[known], lats_deg[known])
        convergence[known] = factors.meridian_convergence
        return convergence

    def _projection(self) -> Proj:
        place = f"+lat_0={self.lat_deg!r} +lon_0={self.lon_deg!r}"
        return Proj(f"+proj=tmerc +ellps=WGS84 +k_0=1 {place}")
