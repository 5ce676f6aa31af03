"""Pure: what is told of one satellite, as far as it can be true."""

from collections.abc import Mapping

from wayline.messages import QUANTITY_MAX, STD_MAX, RawSatellite
from wayline.satellites.earth import Vector

DISTANCE_MIN_M, DISTANCE_MAX_M = 6.5e6, 5.0e7
"""Of a satellite from the earth's centre; 0 is what is written for unknown."""
MOTION_MAX_MPS = 1.0e4
CN0_MAX_DBHZ = 100.0
PLACE, MOTION = ("x_m", "y_m", "z_m"), ("vx_mps", "vy_mps", "vz_mps")
STDS = ("pseudorange_std_m", "doppler_std_hz")
PLAIN = ("doppler_hz", "clock_bias_m", "clock_drift_mps")

Told = Mapping[str, float]
"""Numbers by the fields of RawSatellite; what is not told is not in it."""


def raw_satellite(
    system: str, prn: int, told: Told, *, line_of_sight: bool | None = None
) -> RawSatellite | None:
    """The satellite with what of its numbers can be; None where nothing was measured of it."""
    known = {name: told[name] for name in PLAIN if _fits(told.get(name))}
    pseudorange_m = told.get("pseudorange_m", 0.0)
    if 0.0 < abs(pseudorange_m) <= QUANTITY_MAX:
        known["pseudorange_m"] = pseudorange_m
    if not {"pseudorange_m", "doppler_hz"} & known.keys():
        return None
    known |= {name: told[name] for name in STDS if 0.0 < told.get(name, 0.0) <= STD_MAX}
    known |= _strength(told) | _direction(told)
    known |= _vector(told, PLACE, DISTANCE_MIN_M, DISTANCE_MAX_M)
    if PLACE[0] in known:
        known |= _vector(told, MOTION, 0.0, MOTION_MAX_MPS)
    return RawSatellite(system=system, prn=prn, line_of_sight=line_of_sight, **known)


def place_of(satellite: RawSatellite) -> Vector | None:
    """Where it is, in m, ECEF; None where that is not told."""
    if satellite.x_m is None or satellite.y_m is None or satellite.z_m is None:
        return None
    return Vector(satellite.x_m, satellite.y_m, satellite.z_m)


def _fits(number: float | None) -> bool:
    return number is not None and abs(number) <= QUANTITY_MAX


def _strength(told: Told) -> dict[str, float]:
    known = {}
    if 0.0 < told.get("cn0_dbhz", 0.0) <= CN0_MAX_DBHZ:
        known["cn0_dbhz"] = told["cn0_dbhz"]
    if 0.0 < told.get("carrier_hz", 0.0) <= 1e11:
        known["carrier_hz"] = told["carrier_hz"]
    return known


def _direction(told: Told) -> dict[str, float]:
    known = {}
    if abs(told.get("elevation_deg", 999.0)) <= 90.0:
        known["elevation_deg"] = told["elevation_deg"]
    if abs(told.get("azimuth_deg", 999.0)) <= 360.0:
        known["azimuth_deg"] = told["azimuth_deg"] % 360.0
    return known


def _vector(told: Told, names: tuple[str, ...], least: float, most: float) -> dict[str, float]:
    """All three components, where their length can be; else none."""
    if not all(name in told for name in names):
        return {}
    parts = {name: told[name] for name in names}
    return parts if least <= Vector(*parts.values()).length <= most else {}
