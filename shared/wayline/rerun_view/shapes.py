"""Pure: shapes on the map, as lines of (latitude, longitude) in degrees.

Rerun's map draws points and line strings only, so a heading and an ellipse are lines.
"""

import math

import numpy as np
from numpy.typing import NDArray

from wayline.geo import metres_per_degree
from wayline.messages import Pose

Line = NDArray[np.float64]
"""Shape (vertices, 2): latitude and longitude in degrees."""

ELLIPSE_CHI2 = 5.991464547107979
"""The 95 % quantile of chi-square with two degrees of freedom."""
ELLIPSE_VERTICES = 32
ARROW_LENGTH_M = 40.0
"""Long enough to be seen at the zoom of a street, short enough not to hide the next one."""

TILE_PX = 256
PANE_PX = (600.0, 300.0)
"""Width and height of the map in a window of 1400 x 900, less a margin."""
NEAR_ZOOM = 16.0
"""A few streets: where a map begins that does not know yet how far the vehicle goes."""

_ANGLES_RAD = np.linspace(0.0, 2.0 * math.pi, ELLIPSE_VERTICES + 1)
_CIRCLE = np.stack((np.cos(_ANGLES_RAD), np.sin(_ANGLES_RAD)))
_ARROW_M = np.array([[0.0, 0.0], [0.0, 1.0], [-0.15, 0.75], [0.15, 0.75], [0.0, 1.0]]).T
"""East and north of an arrow that points north, tail first, of length 1."""


def ellipse_of(pose: Pose) -> Line | None:
    """The region that holds the vehicle with 95 %; None without a position or its stds.

    An unknown covariance of east and north counts as none.
    """
    if pose.east_std_m is None or pose.north_std_m is None:
        return None
    east_north_cov_m2 = pose.east_north_cov_m2 or 0.0
    covariance_m2 = np.array(
        [
            [pose.east_std_m**2, east_north_cov_m2],
            [east_north_cov_m2, pose.north_std_m**2],
        ]
    )
    variances_m2, axes = np.linalg.eigh(covariance_m2)
    semi_axes_m = np.sqrt(np.maximum(variances_m2, 0.0) * ELLIPSE_CHI2)
    return _around(pose, axes @ (semi_axes_m[:, None] * _CIRCLE))


def arrow_of(pose: Pose) -> Line | None:
    """An arrow from the vehicle in the direction of its heading; None where one is unknown."""
    if pose.heading_deg is None:
        return None
    heading_rad = math.radians(pose.heading_deg)
    cos, sin = math.cos(heading_rad), math.sin(heading_rad)
    clockwise = np.array([[cos, sin], [-sin, cos]])
    return _around(pose, ARROW_LENGTH_M * (clockwise @ _ARROW_M))


def _around(pose: Pose, east_north_m: Line) -> Line | None:
    """Offsets of shape (2, vertices) from a pose; None without a position.

    A metre counts the same all over the shape, which at a kilometre from 60 degrees north is
    right to a metre.
    """
    if pose.lat_deg is None or pose.lon_deg is None:
        return None
    m_per_lat_deg, m_per_lon_deg = metres_per_degree(pose.lat_deg)
    east_m, north_m = east_north_m
    return np.column_stack(
        (pose.lat_deg + north_m / m_per_lat_deg, pose.lon_deg + east_m / m_per_lon_deg)
    )


class Extent:
    """The rectangle of all positions added, in degrees; across the antimeridian it is the world."""

    def __init__(self) -> None:
        self._south_deg, self._north_deg = math.inf, -math.inf
        self._west_deg, self._east_deg = math.inf, -math.inf

    def add(self, lat_deg: float, lon_deg: float) -> None:
        """Widen it to hold a position."""
        self._south_deg, self._north_deg = (
            min(self._south_deg, lat_deg),
            max(self._north_deg, lat_deg),
        )
        self._west_deg, self._east_deg = min(self._west_deg, lon_deg), max(self._east_deg, lon_deg)

    def zoom(self) -> float:
        """The zoom of a Web Mercator map of PANE_PX that shows it all; NEAR_ZOOM if it is empty."""
        if self._south_deg > self._north_deg:
            return NEAR_ZOOM
        across_deg = self._east_deg - self._west_deg
        middle_rad = math.radians((self._south_deg + self._north_deg) / 2.0)
        up_deg = (self._north_deg - self._south_deg) / math.cos(middle_rad)
        zooms = [
            math.log2(pixels * 360.0 / (TILE_PX * span_deg))
            for pixels, span_deg in zip(PANE_PX, (across_deg, up_deg), strict=True)
            if span_deg > 0.0
        ]
        return max(0.0, min([NEAR_ZOOM, *zooms]))
