"""Satellites on circular orbits and what a receiver measures of them, reckoned in inertial space.

Nothing of it is shared with the code under test: signals travel in straight lines past an earth
that turns, and Dopplers are differences of ranges.
"""

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from pyproj import Transformer

from builders import at
from wayline.messages import GpsRaw, RawSatellite

Floats = NDArray[np.float64]

LIGHT_MPS = 299_792_458.0
L1_HZ = 1_575.42e6
TURN_RADPS = 7.2921151467e-5
PULL_M3PS2 = 3.986004418e14
RADIUS_M = 26_559_700.0
TO_ECEF = Transformer.from_crs("EPSG:4979", "EPSG:4978", always_xy=True)
APART_S = 0.05
"""Between the ranges of a difference, to either side."""

Place = Callable[[float], Floats]
"""ECEF of the receiver at a time, m."""
Clock = Callable[[float], float]
"""What a receiver's clock adds to pseudoranges at a time, m."""


def ecef(lat_deg: float, lon_deg: float, height_m: float = 0.0) -> Floats:
    return np.array(TO_ECEF.transform(lon_deg, lat_deg, height_m))


def turned(vectors_m: Floats, angle_rad: Floats | float) -> Floats:
    """About the pole, shape (..., 3)."""
    sin, cos = np.sin(angle_rad), np.cos(angle_rad)
    x, y, z = vectors_m[..., 0], vectors_m[..., 1], vectors_m[..., 2]
    return np.stack((cos * x - sin * y, sin * x + cos * y, z), axis=-1)


class Sky(NamedTuple):
    """Satellites on orbits inclined by 55 degrees; angles in radians, shape (n,)."""

    nodes: Floats
    phases: Floats

    def inertial_m(self, seconds: Floats | float) -> Floats:
        """Places, shape (n, 3); the axes are the earth's at time 0."""
        along = self.phases + np.sqrt(PULL_M3PS2 / RADIUS_M**3) * seconds
        tilt = np.radians(55.0)
        orbit = np.stack(
            (np.cos(along), np.sin(along) * np.cos(tilt), np.sin(along) * np.sin(tilt)), axis=-1
        )
        return RADIUS_M * turned(orbit, self.nodes)

    def ecef_m(self, seconds: Floats | float) -> Floats:
        return turned(self.inertial_m(seconds), -TURN_RADPS * seconds)

    def flights_s(self, place: Place, seconds: float) -> Floats:
        """How long signals have travelled that arrive now."""
        here_m = turned(place(seconds), TURN_RADPS * seconds)
        flights_s = np.full(len(self.nodes), 0.07)
        for _ in range(5):
            ways_m = self.inertial_m(seconds - flights_s) - here_m
            flights_s = np.linalg.norm(ways_m, axis=1) / LIGHT_MPS
        return flights_s

    def pseudoranges_m(self, place: Place, clock: Clock, seconds: float) -> Floats:
        return LIGHT_MPS * self.flights_s(place, seconds) + clock(seconds)

    def dopplers_hz(self, place: Place, clock: Clock, seconds: float) -> Floats:
        after_m, before_m = (
            self.pseudoranges_m(place, clock, seconds + step) for step in (APART_S, -APART_S)
        )
        return -(after_m - before_m) / (2.0 * APART_S) * L1_HZ / LIGHT_MPS


def sky_over(lat_deg: float, lon_deg: float, count: int = 12, lowest_deg: float = 10.0) -> Sky:
    """Satellites that stand above a place at time 0, and stay there for an hour or so."""
    random = np.random.default_rng(5)
    candidates = Sky(*random.uniform(0.0, 2.0 * np.pi, (2, 400)))
    here_m = ecef(lat_deg, lon_deg)
    rays = candidates.inertial_m(0.0) - here_m
    up = here_m / np.linalg.norm(here_m)
    highest = rays @ up / np.linalg.norm(rays, axis=1)
    chosen = np.flatnonzero(highest > np.sin(np.radians(lowest_deg)))[:count]
    return Sky(candidates.nodes[chosen], candidates.phases[chosen])


def epoch(
    sky: Sky,
    place: Place,
    clock: Clock,
    seconds: float,
    *,
    doppler_std_hz: float = 0.0,
    seed: int = 0,
    only: Sequence[int] | None = None,
    **fields: Any,
) -> GpsRaw:
    """What a receiver measures, with noise on its Dopplers; `only` those satellites' numbers."""
    sent_s = seconds - sky.flights_s(place, seconds)
    places_m = sky.ecef_m(sent_s)
    motions_mps = (sky.ecef_m(sent_s + APART_S) - sky.ecef_m(sent_s - APART_S)) / (2.0 * APART_S)
    ranges_m = sky.pseudoranges_m(place, clock, seconds)
    dopplers_hz = sky.dopplers_hz(place, clock, seconds)
    noise = np.random.default_rng([seed, round(10.0 * seconds)]).standard_normal(len(ranges_m))
    dopplers_hz += doppler_std_hz * noise
    satellites = []
    for number, row in enumerate(np.column_stack((places_m, motions_mps)).tolist()):
        if only is None or number in only:
            known: dict[str, Any] = {
                "pseudorange_m": float(ranges_m[number]),
                "doppler_hz": float(dopplers_hz[number]),
                "doppler_std_hz": max(doppler_std_hz, 0.01),
                "carrier_hz": L1_HZ,
                **dict(zip(("x_m", "y_m", "z_m", "vx_mps", "vy_mps", "vz_mps"), row, strict=True)),
                **fields,
            }
            satellites.append(RawSatellite(system="gps", prn=number + 1, **known))
    return GpsRaw(t_ns=at(seconds), satellites=tuple(satellites))
