"""Pure: an epoch of raw measurements as an event: what of it can be used, as arrays."""

from collections.abc import Sequence

import numpy as np

from wayline.messages import GpsRaw, RawSatellite
from wayline.satellites.earth import SPEED_OF_LIGHT_MPS
from wayline_fusion.intake.events import Ranges

LETTERS = {
    "gps": "G",
    "glonass": "R",
    "galileo": "E",
    "beidou": "C",
    "qzss": "J",
    "sbas": "S",
    "navic": "I",
}
"""As RINEX calls the systems."""
NEAREST_M, FARTHEST_M = 1.5e7, 6e7
"""A satellite that tells of a distance outside has lost its clock, or is none."""


def ranges_of(epoch: GpsRaw) -> Ranges | None:
    """The satellites whose place and pseudorange are told; None of an epoch without any."""
    usable = [each for each in epoch.satellites if _is_usable(each)]
    if not usable:
        return None
    return Ranges(
        epoch.t_ns,
        tuple(f"{LETTERS[each.system]}{each.prn}" for each in usable),
        tuple(each.system for each in usable),
        np.array([(each.x_m, each.y_m, each.z_m) for each in usable], dtype=np.float64),
        _column([each.pseudorange_m for each in usable])
        + np.array([each.clock_bias_m or 0.0 for each in usable]),
        _column([each.pseudorange_std_m for each in usable]),
        _column([each.cn0_dbhz for each in usable]),
        np.array([(each.vx_mps, each.vy_mps, each.vz_mps) for each in usable], dtype=np.float64),
        _column([_range_rate_mps(each) for each in usable]),
        _column([_rate_std_mps(each) for each in usable]),
    )


def _is_usable(satellite: RawSatellite) -> bool:
    place = satellite.x_m, satellite.y_m, satellite.z_m
    if satellite.system not in LETTERS or satellite.pseudorange_m is None or None in place:
        return False
    return NEAREST_M < satellite.pseudorange_m < FARTHEST_M


def _column(values: Sequence[float | None]) -> np.ndarray:
    """What is not told is nan."""
    return np.array(values, dtype=np.float64)


def _range_rate_mps(satellite: RawSatellite) -> float | None:
    """How fast the satellite goes away, its clock's drift taken off."""
    if satellite.doppler_hz is None or satellite.carrier_hz is None:
        return None
    wave_m = SPEED_OF_LIGHT_MPS / satellite.carrier_hz
    return -satellite.doppler_hz * wave_m + (satellite.clock_drift_mps or 0.0)


def _rate_std_mps(satellite: RawSatellite) -> float | None:
    if satellite.doppler_std_hz is None or satellite.carrier_hz is None:
        return None
    return satellite.doppler_std_hz * SPEED_OF_LIGHT_MPS / satellite.carrier_hz
