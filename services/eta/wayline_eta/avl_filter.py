"""Pure: the published route filter of papers/000 (eq. 2 to 28), kept as a reference.

A Kalman filter on the position in a plane, in metres, whose prediction runs along the planned
route at its planned speeds. Corrections to the printed equations are listed in the README of the
papers' tables: eq. 5 divides by the squared length, and eq. 22 lacks that same division, so that
with unit vectors A = (v_next / v_leg) u_next u_leg^T.
"""

import math
from typing import NamedTuple

import numpy as np
from filterpy.kalman import KalmanFilter
from numpy.typing import NDArray

from wayline.geo import LocalPlane
from wayline.line import Projection
from wayline.route import Route

Floats = NDArray[np.float64]

PROCESS_NOISE_M2 = 10.0
"""Diagonal of Q, eq. 24."""
MEASUREMENT_NOISE_M2 = 15.0
"""Diagonal of R, eq. 26; also of the first P."""
STEP_S = 1.0
"""One step a received row, whatever its time (inferred from appendix D)."""


class Estimate(NamedTuple):
    """The filter's own position, which lies beside the route, and its place along the route."""

    lat_deg: float
    lon_deg: float
    place: Projection
    distance_std_m: float
    ended: bool
    """The prediction has reached the end of an open route."""
    covariance_m2: tuple[tuple[float, float], tuple[float, float]]
    """Of east and north."""


class AvlRouteFilter:
    """Position along a planned route from fixes alone; starts at the first fix."""

    def __init__(self, route: Route) -> None:
        self._route = route
        self._plane = LocalPlane(float(route.line.lats_deg[0]), float(route.line.lons_deg[0]))
        self._kalman: KalmanFilter | None = None
        self._ended = False

    def step(self, position: tuple[float, float] | None) -> Estimate | None:
        """Go on by one row: a fix's latitude and longitude, or None for a repeat or no position.

        None until the first fix.
        """
        if self._kalman is None:
            if position is None:
                return None
            self._kalman = _started(np.array(self._plane.to_plane(*position)))
        else:
            self._predict(self._kalman)
            if position is not None:
                self._kalman.update(np.array(self._plane.to_plane(*position)))
        return self._estimate(self._kalman)

    def _predict(self, kalman: KalmanFilter) -> None:
        """Eq. 6 to 23: along the route for one step, at the speed of each leg crossed."""
        route, line = self._route, self._route.line
        here = self._project(kalman.x)
        time_s = float(route.time_at(np.array([here.distance_m]))[0]) + STEP_S
        next_m = route.distance_at(time_s)
        if route.loop:
            next_m %= route.length_m
        lat_deg, lon_deg, _ = line.point_at(next_m)
        ahead = np.array(self._plane.to_plane(lat_deg, lon_deg))
        leg, next_leg = line.leg_at(here.distance_m), line.leg_at(next_m)
        self._ended = not route.loop and time_s >= route.duration_s
        speed_ratio = 0.0 if self._ended else route.speeds_mps[next_leg] / route.speeds_mps[leg]
        A = speed_ratio * np.outer(
            _along(line.headings_deg[next_leg]), _along(line.headings_deg[leg])
        )
        # f(x) is not A x; the difference goes in as a control, so filterpy's algebra stays whole
        kalman.predict(u=ahead - A @ kalman.x, B=np.eye(2), F=A)

    def _estimate(self, kalman: KalmanFilter) -> Estimate:
        lat_deg, lon_deg = self._plane.to_geodetic(*kalman.x)
        place = self._project(kalman.x)
        along = _along(place.heading_deg)
        std_m = math.sqrt(float(along @ kalman.P @ along))
        (east_m2, shared_m2), (_, north_m2) = kalman.P.tolist()
        covariance_m2 = (east_m2, shared_m2), (shared_m2, north_m2)
        return Estimate(lat_deg, lon_deg, place, std_m, self._ended, covariance_m2)

    def _project(self, x: Floats) -> Projection:
        """Eq. 2 to 5: the nearest point of the route."""
        place = self._route.line.project(*self._plane.to_geodetic(*x))
        assert place is not None  # without a heading every leg qualifies  # noqa: S101
        return place


def _started(position_m: Floats) -> KalmanFilter:
    kalman = KalmanFilter(dim_x=2, dim_z=2)
    kalman.x = position_m
    kalman.P = MEASUREMENT_NOISE_M2 * np.eye(2)
    kalman.Q = PROCESS_NOISE_M2 * np.eye(2)
    kalman.R = MEASUREMENT_NOISE_M2 * np.eye(2)
    kalman.H = np.eye(2)
    return kalman


def _along(heading_deg: float) -> Floats:
    """Unit vector (east, north) of a heading."""
    heading_rad = math.radians(heading_deg)
    return np.array([math.sin(heading_rad), math.cos(heading_rad)])
