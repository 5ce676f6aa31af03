"""Pure: what a moving receiver should measure of satellites, with stds (papers/001).

Frame: Earth-centred, Earth-fixed (ECEF), metres. A satellite's place is that of the transmission;
while the signal travels the Earth turns under it, which is taken into account here. A range rate is
positive while the range grows; Doppler is positive while it shrinks.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from pyproj import Transformer

from wayline.satellites.earth import EARTH_MU_M3PS2, EARTH_RATE_RADPS, SPEED_OF_LIGHT_MPS

Floats = NDArray[np.float64]

L1_HZ = 1_575.42e6
UNMODELLED_MPS2 = 1e-4
"""The Earth's flattening, the moon and the sun pull a satellite by less."""
TO_ECEF = Transformer.from_crs("EPSG:4979", "EPSG:4978", always_xy=True)


class Antenna(NamedTuple):
    """A receiver's place and motion, with one sigma of what is not known of them."""

    place_m: Floats
    velocity_mps: Floats
    axes: Floats
    """Columns: ahead, to the right and up, in ECEF; shape (3, 3)."""
    velocity_variances: Floats
    """Along these axes, (m/s)^2."""
    place_std_m: float


class AntennaMotion(NamedTuple):
    """A vehicle's place above the ellipsoid and its motion, degrees, m, m/s; stds one sigma."""

    lat_deg: float
    lon_deg: float
    height_m: float
    heading_deg: float
    speed_mps: float
    """Negative in reverse."""
    grade_pct: float
    place_std_m: float
    heading_std_deg: float
    speed_std_mps: float
    grade_std_pct: float


def antenna_of(motion: AntennaMotion) -> Antenna:
    """The vehicle's motion in the satellites' frame."""
    sin_lat, cos_lat = _sin_cos(motion.lat_deg)
    sin_lon, cos_lon = _sin_cos(motion.lon_deg)
    sin, cos = _sin_cos(motion.heading_deg)
    east = (-sin_lon, cos_lon, 0.0)
    north = (-sin_lat * cos_lon, -sin_lat * sin_lon, cos_lat)
    up = (cos_lat * cos_lon, cos_lat * sin_lon, sin_lat)
    axes = np.array(
        [(sin * e + cos * n, cos * e - sin * n, u) for e, n, u in zip(east, north, up, strict=True)]
    )
    speed_mps, slope = motion.speed_mps, 0.01 * motion.grade_pct
    across_mps = speed_mps * math.radians(motion.heading_std_deg)
    up_mps = math.hypot(0.01 * motion.grade_std_pct * speed_mps, slope * motion.speed_std_mps)
    return Antenna(
        place_m=np.array(TO_ECEF.transform(motion.lon_deg, motion.lat_deg, motion.height_m)),
        velocity_mps=axes.dot((speed_mps, 0.0, slope * speed_mps)),
        axes=axes,
        velocity_variances=np.array((motion.speed_std_mps**2, across_mps**2, up_mps**2)),
        place_std_m=motion.place_std_m,
    )


def _sin_cos(angle_deg: float) -> tuple[float, float]:
    angle_rad = math.radians(angle_deg)
    return math.sin(angle_rad), math.cos(angle_rad)


class Orbits(NamedTuple):
    """Where satellites were and how they moved, shape (n, 3) each, at an instant of their own."""

    places_m: Floats
    velocities_mps: Floats
    accelerations_mps2: Floats
    t_ns: NDArray[np.int64]
    """When a receiver heard what they sent from there, shape (n,)."""


def orbits_of(places_m: Floats, velocities_mps: Floats, t_ns: NDArray[np.int64]) -> Orbits:
    """With the acceleration that the Earth gives them."""
    return Orbits(places_m, velocities_mps, accelerations_mps2(places_m, velocities_mps), t_ns)


def accelerations_mps2(places_m: Floats, velocities_mps: Floats) -> Floats:
    """Of satellites in the turning frame: the Earth's pull, centrifugal and Coriolis."""
    radius_m = np.sqrt(np.einsum("ij,ij->i", places_m, places_m))
    pull: Floats = -(EARTH_MU_M3PS2 / radius_m**3)[:, np.newaxis] * places_m
    turn = EARTH_RATE_RADPS
    pull[:, 0] += turn * (turn * places_m[:, 0] + 2.0 * velocities_mps[:, 1])
    pull[:, 1] += turn * (turn * places_m[:, 1] - 2.0 * velocities_mps[:, 0])
    return pull


def carried(orbits: Orbits, t_ns: int) -> Orbits:
    """Satellites at another instant, by one Runge-Kutta step each: 1 cm off after a minute."""
    step_s = ((t_ns - orbits.t_ns) * 1e-9)[:, np.newaxis]
    half_s = 0.5 * step_s
    place, velocity, a1 = orbits.places_m, orbits.velocities_mps, orbits.accelerations_mps2
    v2 = velocity + half_s * a1
    a2 = accelerations_mps2(place + half_s * velocity, v2)
    v3 = velocity + half_s * a2
    a3 = accelerations_mps2(place + half_s * v2, v3)
    v4 = velocity + step_s * a3
    a4 = accelerations_mps2(place + step_s * v3, v4)
    return orbits_of(
        place + step_s / 6.0 * (velocity + 2.0 * v2 + 2.0 * v3 + v4),
        velocity + step_s / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4),
        np.full_like(orbits.t_ns, t_ns),
    )


class Expected(NamedTuple):
    """Of each satellite, shape (n,), without both clocks."""

    ranges_m: Floats
    rates_mps: Floats
    rate_variances: Floats
    """By the receiver's velocity and place, (m/s)^2."""
    ups: Floats
    """Sines of elevations."""
    by_axes: Floats
    """How a range rate shrinks with the velocity ahead, to the right and up, shape (n, 3)."""


def expected(antenna: Antenna, orbits: Orbits, t_ns: int) -> Expected:
    """What should be measured at an instant within ten seconds or so of the orbits' own."""
    after_s = ((t_ns - orbits.t_ns) * 1e-9)[:, np.newaxis]
    gained_mps = after_s * orbits.accelerations_mps2
    velocities_mps = orbits.velocities_mps + gained_mps
    places_m = orbits.places_m + after_s * (velocities_mps - 0.5 * gained_mps)
    rays_m = places_m - antenna.place_m
    turned = EARTH_RATE_RADPS / SPEED_OF_LIGHT_MPS * np.sqrt(np.einsum("ij,ij->i", rays_m, rays_m))
    rays_m[:, 0] += turned * places_m[:, 1]
    rays_m[:, 1] -= turned * places_m[:, 0]
    relative_mps = velocities_mps - antenna.velocity_mps
    relative_mps[:, 0] += turned * velocities_mps[:, 1]
    relative_mps[:, 1] -= turned * velocities_mps[:, 0]
    ranges_m = np.sqrt(np.einsum("ij,ij->i", rays_m, rays_m))
    rates_mps = np.einsum("ij,ij->i", rays_m, relative_mps) / ranges_m
    by_axes = rays_m.dot(antenna.axes) / ranges_m[:, np.newaxis]
    # a place beside the true one sees the satellite's motion from elsewhere
    across = np.einsum("ij,ij->i", relative_mps, relative_mps) - rates_mps**2
    by_place = across * (antenna.place_std_m / ranges_m) ** 2
    variances = (by_axes * by_axes).dot(antenna.velocity_variances) + by_place
    return Expected(ranges_m, rates_mps, variances, by_axes[:, 2], by_axes)
