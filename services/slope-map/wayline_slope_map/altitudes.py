"""Pure: the altitude measurements of a run, each with an honest std, ready to be smoothed."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wayline.air import metres_per_pascal, pressure_altitude_m
from wayline.line import Floats
from wayline.resolution import PRESSURE_UNIT_PA, Resolution
from wayline.tuning import Tuning
from wayline_slope_map.track import Altitude, Pressure, Track


class Measured(NamedTuple):
    """Altitudes of one sensor, shape (n,) each, in order of time."""

    times_s: Floats
    travelled_m: Floats
    alt_m: Floats
    std_m: Floats
    receiver: NDArray[np.intp]
    """Its number, in order of first hearing; 0 for a barometer."""


def gps_altitudes(track: Track, tuning: Tuning) -> Measured:
    """GPS altitudes; those that the receiver itself hardly trusts (a cold start) are left out."""
    usable = [
        altitude
        for altitude in _within(track, track.altitudes)
        if not is_hardly_known(altitude, tuning)
    ]
    return _measured(track, usable)


def is_hardly_known(altitude: Altitude, tuning: Tuning) -> bool:
    """Whether the receiver itself hardly trusts an altitude: it has just begun."""
    return altitude.std_m > tuning.map_gps_std_max_m


def barometer_altitudes(track: Track, tuning: Tuning) -> Measured:
    """Altitudes in the standard atmosphere; none where the sensor's steps are too coarse.

    Readings that do not change share one rounding error, so that n equal ones together weigh
    like one.
    """
    readings = sorted(
        reading
        for reading in track.pressures
        if track.start_ns <= reading.t_ns <= track.times_ns[-1]
    )
    steps = Resolution(PRESSURE_UNIT_PA)
    for reading in readings:
        steps.learn(reading.pressure_pa)
    altitudes = []
    for same in _equal_in_a_row(readings):
        pressure_pa = same[0].pressure_pa
        rounding_m = steps.std * metres_per_pascal(pressure_pa)
        if rounding_m > tuning.baro_resolution_std_max_m:
            continue
        std_m = math.hypot(rounding_m * math.sqrt(len(same)), tuning.baro_std_m)
        alt_m = pressure_altitude_m(pressure_pa)
        altitudes += [Altitude(reading.t_ns, alt_m, std_m) for reading in same]
    return _measured(track, altitudes)


def _equal_in_a_row(readings: list[Pressure]) -> list[list[Pressure]]:
    groups: list[list[Pressure]] = []
    for reading in readings:
        if groups and groups[-1][0].pressure_pa == reading.pressure_pa:
            groups[-1].append(reading)
        else:
            groups.append([reading])
    return groups


def _within(track: Track, altitudes: list[Altitude]) -> list[Altitude]:
    """Altitudes measured during the run, in order of time; a late fix may be of the one before."""
    last_ns = track.times_ns[-1]
    return sorted(altitude for altitude in altitudes if track.start_ns <= altitude.t_ns <= last_ns)


def _measured(track: Track, altitudes: list[Altitude]) -> Measured:
    times_s = track.seconds([altitude.t_ns for altitude in altitudes])
    sources = list(dict.fromkeys(altitude.source for altitude in altitudes))
    return Measured(
        times_s,
        track.travelled_at(times_s),
        np.array([altitude.alt_m for altitude in altitudes], dtype=np.float64),
        np.array([altitude.std_m for altitude in altitudes], dtype=np.float64),
        np.array([sources.index(altitude.source) for altitude in altitudes], dtype=np.intp),
    )
