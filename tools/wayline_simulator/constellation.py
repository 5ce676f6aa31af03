"""Pure: where the satellites stand, by their nominal orbits.

Circular orbits in evenly spaced planes turn under a rotating earth: the sky of a given minute is
not the true one, but it has as many satellites, as high, moving as fast. Precession of the planes
and the leap seconds between UTC and UT1 are left out; both only turn the sky a little.
"""

from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray
from pyproj import Transformer

from wayline_simulator.journey import Floats

System = Literal["gps", "glonass", "galileo"]

EARTH_MU_M3PS2 = 3.986004418e14
"""WGS84's gravitational constant of the earth."""
J2000_UNIX_S = 946_728_000.0
"""2000-01-01 12:00 UTC."""
TURNS_AT_J2000 = 0.7790572732640
TURNS_PER_DAY = 1.00273781191135448
"""IERS Conventions 2010, equation 5.15: the earth rotation angle."""
SKY_STEP_S = 10.0
"""A satellite moves by less than 0.1 degrees across the sky in it."""
TO_EARTH_FIXED = Transformer.from_crs("EPSG:4979", "EPSG:4978", always_xy=True)


class Orbits(NamedTuple):
    """A constellation of `planes` times `slots` satellites, Walker's scheme."""

    planes: int
    slots: int
    inclination_deg: float
    radius_m: float
    phase_deg: float
    """A satellite is so far ahead of its like in the plane to the west."""
    first_prn: int
    """As NMEA 0183 counts them."""


ORBITS: dict[System, Orbits] = {
    # SPS Performance Standard: six planes; five satellites in each are near today's 31, and so
    # phased PDOP stays below 2.5 under an open sky, as its section on availability has it
    "gps": Orbits(6, 5, 55.0, 26_559_700.0, 12.0, 1),
    # GLONASS ICD: 24 in three planes, 45 degrees apart, 15 from plane to plane
    "glonass": Orbits(3, 8, 64.8, 25_510_000.0, 15.0, 65),
    # Galileo OS SIS ICD: Walker 24/3/1
    "galileo": Orbits(3, 8, 56.0, 29_600_000.0, 15.0, 1),
}


class Heavens(NamedTuple):
    """Directions to satellites. Shapes (n, satellites), or (satellites,) where they stay."""

    azimuths_rad: Floats
    elevations_rad: Floats
    systems: NDArray[np.intp]
    """Index into the systems asked for."""
    prns: NDArray[np.intp]


def heavens(
    times_s: Floats, lats_deg: Floats, lons_deg: Floats, systems: tuple[System, ...]
) -> Heavens:
    """Where satellites stand at Unix times, seen from a place each. Inputs of shape (n,)."""
    places_m = np.stack(TO_EARTH_FIXED.transform(lons_deg, lats_deg, np.zeros_like(lats_deg)), -1)
    rays_m = satellites_m(times_s[:, np.newaxis], systems) - places_m[:, np.newaxis, :]
    rays = rays_m / np.linalg.norm(rays_m, axis=2, keepdims=True)
    east, north, up = np.moveaxis(rays @ local_axes(lats_deg, lons_deg), 2, 0)
    counts = [_count(system) for system in systems]
    return Heavens(
        azimuths_rad=np.arctan2(east, north) % (2.0 * np.pi),
        elevations_rad=np.arcsin(np.clip(up, -1.0, 1.0)),
        systems=np.repeat(np.arange(len(systems)), counts),
        prns=np.concatenate(
            [
                ORBITS[system].first_prn + np.arange(count)
                for system, count in zip(systems, counts, strict=True)
            ]
        ),
    )


def satellites_m(times_s: Floats, systems: tuple[System, ...]) -> Floats:
    """Earth-fixed places, shape (n, satellites, 3), in the frame of each one's own instant.

    `times_s`: Unix time, of shape (n, 1) for all satellites or (n, satellites) for each.
    """
    ends = np.cumsum([_count(system) for system in systems])
    each_s = np.broadcast_to(times_s, (len(times_s), int(ends[-1])))
    parts_s = np.split(each_s, ends[:-1], axis=1)
    parts = [
        _constellation_m(part_s, ORBITS[system])
        for part_s, system in zip(parts_s, systems, strict=True)
    ]
    return np.concatenate(parts, axis=1)


def _count(system: System) -> int:
    return ORBITS[system].planes * ORBITS[system].slots


def _constellation_m(times_s: Floats, orbits: Orbits) -> Floats:
    """Of times of shape (n, planes times slots)."""
    turns = TURNS_AT_J2000 + TURNS_PER_DAY * (times_s - J2000_UNIX_S) / 86_400.0
    plane, slot = np.divmod(np.arange(orbits.planes * orbits.slots), orbits.slots)
    rate_radps = np.sqrt(EARTH_MU_M3PS2 / orbits.radius_m**3)
    start_rad = np.radians(slot * 360.0 / orbits.slots + plane * orbits.phase_deg)
    along = start_rad + rate_radps * (times_s - J2000_UNIX_S)
    node = 2.0 * np.pi * (plane / orbits.planes - turns % 1.0)
    tilt = np.radians(orbits.inclination_deg)
    x = np.cos(along) * np.cos(node) - np.sin(along) * np.cos(tilt) * np.sin(node)
    y = np.cos(along) * np.sin(node) + np.sin(along) * np.cos(tilt) * np.cos(node)
    return orbits.radius_m * np.stack((x, y, np.sin(along) * np.sin(tilt)), axis=-1)


def local_axes(lats_deg: Floats, lons_deg: Floats) -> Floats:
    """Columns east, north and up in earth-fixed coordinates, shape (n, 3, 3)."""
    lat, lon = np.radians(lats_deg), np.radians(lons_deg)
    sin_lat, cos_lat, sin_lon, cos_lon = np.sin(lat), np.cos(lat), np.sin(lon), np.cos(lon)
    east = np.stack((-sin_lon, cos_lon, np.zeros_like(lon)), axis=-1)
    north = np.stack((-sin_lat * cos_lon, -sin_lat * sin_lon, cos_lat), axis=-1)
    up = np.stack((cos_lat * cos_lon, cos_lat * sin_lon, sin_lat), axis=-1)
    return np.stack((east, north, up), axis=-1)
