"""Pure: what a receiver measures of each satellite, epoch after epoch."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wayline.satellites.earth import EARTH_RATE_RADPS, SPEED_OF_LIGHT_MPS
from wayline_simulator.constellation import (
    ORBITS,
    TO_EARTH_FIXED,
    System,
    local_axes,
    satellites_m,
)
from wayline_simulator.gps import Fixes
from wayline_simulator.gps_model import GpsModel
from wayline_simulator.journey import Floats, Truth
from wayline_simulator.raw_errors import RawErrors
from wayline_simulator.receiver import GEOID_SEP_M

CHUNK = 1000
"""Epochs whose geometry is held in memory at once."""
FLIGHT_S = 0.075
"""Of a signal, before it is known better; two rounds bring it within a nanosecond."""
DIFFERENCED_S = 0.5
GLONASS_HZ, GLONASS_STEP_HZ, GLONASS_CHANNELS = 1602.0e6, 0.5625e6, 14
"""GLONASS ICD: L1, a channel of its own for satellites that see each other; from -7 on."""
L1_HZ = 1575.42e6


class Measured(NamedTuple):
    """What is told of satellites, a row each in order of time. Shape (n,) each."""

    times_s: Floats
    """Unix time."""
    systems: NDArray[np.intp]
    """Index into the receiver's systems."""
    prns: NDArray[np.intp]
    """As the systems count them themselves, from 1."""
    pseudoranges_m: Floats
    pseudorange_stds_m: Floats
    dopplers_hz: Floats
    doppler_stds_hz: Floats
    strengths_dbhz: Floats
    carriers_hz: Floats
    elevations_deg: Floats
    azimuths_deg: Floats
    in_sight: NDArray[np.bool_]
    places_m: Floats
    """Shape (n, 3), at the transmission, in the earth-fixed frame of then."""
    motions_mps: Floats
    """Shape (n, 3)."""


def measure_raw(
    truth: Truth, fixes: Fixes, gps: GpsModel, errors: RawErrors, least_dbhz: float
) -> Iterator[Measured]:
    """What the receiver that made the fixes measured, some epochs at a time.

    `truth` is that of the fixes' timestamps. What is weaker than `least_dbhz` is not measured.
    """
    view, rows = fixes.view, fixes.rows
    heard = (view.strengths_dbhz >= least_dbhz) & (view.elevations_deg >= gps.mask_deg)
    heard = heard[rows] & (fixes.sky_seen & ~fixes.repeated)[:, np.newaxis]
    for first in range(0, len(rows), CHUNK):
        part = slice(first, first + CHUNK)
        geometry = _geometry(truth, part, fixes.timestamps_s[part], gps.systems)
        offsets_m = errors.clock_m[part, np.newaxis] + errors.offsets_m[view.systems]
        drifts_mps = errors.drift_mps[part, np.newaxis]
        told = geometry._replace(
            ranges_m=geometry.ranges_m + offsets_m + errors.code_m[part],
            rates_mps=geometry.rates_mps + drifts_mps + errors.rate_mps[part],
        )
        each = np.nonzero(heard[part])
        yield _measured(each, part, told, fixes=fixes, gps=gps, errors=errors)


def _measured(
    each: tuple[NDArray[np.intp], ...],
    part: slice,
    told: "_Geometry",
    *,
    fixes: Fixes,
    gps: GpsModel,
    errors: RawErrors,
) -> Measured:
    """Of a part of the epochs the satellites at `each`: numbers of the epoch and the satellite."""
    epoch, satellite = each
    view, rows = fixes.view, fixes.rows[part]
    carriers_hz = _carriers_hz(gps.systems)[satellite]
    hz_per_mps = carriers_hz / SPEED_OF_LIGHT_MPS
    systems = view.systems[satellite]
    first_prns = np.array([ORBITS[system].first_prn for system in gps.systems])
    return Measured(
        times_s=fixes.timestamps_s[part][epoch],
        systems=systems,
        prns=view.prns[satellite] - first_prns[systems] + 1,
        pseudoranges_m=told.ranges_m[each],
        pseudorange_stds_m=errors.code_std_m[part][each],
        dopplers_hz=-told.rates_mps[each] * hz_per_mps,
        doppler_stds_hz=errors.rate_std_mps[part][each] * hz_per_mps,
        strengths_dbhz=view.strengths_dbhz[rows][each].astype(np.float64),
        carriers_hz=carriers_hz,
        elevations_deg=view.elevations_deg[rows][each].astype(np.float64),
        azimuths_deg=view.azimuths_deg[rows][each].astype(np.float64),
        in_sight=view.clear[rows][each],
        places_m=told.places_m[each],
        motions_mps=told.motions_mps[each],
    )


class _Geometry(NamedTuple):
    """Shapes (n, satellites) and (n, satellites, 3)."""

    ranges_m: Floats
    rates_mps: Floats
    places_m: Floats
    motions_mps: Floats


def _geometry(truth: Truth, part: slice, times_s: Floats, systems: tuple[System, ...]) -> _Geometry:
    """Ranges that signals travelled, and how fast these grow."""
    own_m, own_mps = _own(truth, part)
    flights_s = np.full((1, 1), FLIGHT_S)
    for _ in range(2):
        sent_s = times_s[:, np.newaxis] - flights_s
        places_m = satellites_m(sent_s, systems)
        rays_m = _turned(places_m, flights_s) - own_m
        ranges_m = np.linalg.norm(rays_m, axis=2)
        flights_s = ranges_m / SPEED_OF_LIGHT_MPS
    after_m = satellites_m(sent_s + DIFFERENCED_S, systems)
    motions_mps = (after_m - satellites_m(sent_s - DIFFERENCED_S, systems)) / (2.0 * DIFFERENCED_S)
    closing_mps = _turned(motions_mps, flights_s) - own_mps
    rates_mps = np.sum(rays_m * closing_mps, axis=2) / ranges_m
    return _Geometry(ranges_m, rates_mps, places_m, motions_mps)


def _own(truth: Truth, part: slice) -> tuple[Floats, Floats]:
    """The antenna's place and motion, earth-fixed, shape (n, 1, 3) each."""
    lats_deg, lons_deg = truth.lats_deg[part], truth.lons_deg[part]
    heights_m = truth.alts_m[part] + GEOID_SEP_M
    places_m = np.stack(TO_EARTH_FIXED.transform(lons_deg, lats_deg, heights_m), axis=-1)
    speeds_mps, courses_rad = np.abs(truth.speeds_mps[part]), np.radians(truth.courses_deg[part])
    local_mps = speeds_mps[:, np.newaxis] * np.stack(
        (np.sin(courses_rad), np.cos(courses_rad), truth.grades_pct[part] / 100.0), axis=-1
    )
    motions_mps = local_axes(lats_deg, lons_deg) @ local_mps[:, :, np.newaxis]
    return places_m[:, np.newaxis, :], np.swapaxes(motions_mps, 1, 2)


def _turned(vectors: Floats, flights_s: Floats) -> Floats:
    """Earth-fixed vectors in the frame that holds a flight later; shape (n, satellites, 3)."""
    angles_rad = EARTH_RATE_RADPS * flights_s
    cos, sin = np.cos(angles_rad), np.sin(angles_rad)
    x, y, z = np.moveaxis(vectors, 2, 0)
    return np.stack((cos * x + sin * y, cos * y - sin * x, z), axis=-1)


def _carriers_hz(systems: tuple[System, ...]) -> Floats:
    """Of every satellite, shape (satellites,)."""
    parts = []
    for system in systems:
        number = np.arange(ORBITS[system].planes * ORBITS[system].slots)
        channel = number % GLONASS_CHANNELS - GLONASS_CHANNELS // 2
        is_glonass = system == "glonass"
        parts.append(np.where(is_glonass, GLONASS_HZ + channel * GLONASS_STEP_HZ, L1_HZ))
    return np.concatenate(parts)
