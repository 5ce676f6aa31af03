"""Pure: what is told of one satellite, as far as it can be true."""

from collections.abc import Mapping

from wayline.messages import QUANTITY_MAX, STD_MAX, RawSatellite
from wayline.satellites.earth import Vector

DISTANCE_MIN_M, DISTANCE_MAX_M = 6.5e6, 5.0e7
"""Of a satellite from the earth's centre; 0 is what is written for unknown."""
MOTION_MAX_MPS = 1.0e4
CN0_MAX_DBHZ = 100.0
CARRIER_MAX_HZ = 1e11
ABOVE_ZERO = 5e-324
"""The least number that is; 0 is what is written for unknown."""
PLACE, MOTION = ("x_m", "y_m", "z_m"), ("vx_mps", "vy_mps", "vz_mps")
BOUNDS = {
    "pseudorange_m": (-QUANTITY_MAX, QUANTITY_MAX),
    "pseudorange_std_m": (ABOVE_ZERO, STD_MAX),
    "doppler_hz": (-QUANTITY_MAX, QUANTITY_MAX),
    "doppler_std_hz": (ABOVE_ZERO, STD_MAX),
    "cn0_dbhz": (ABOVE_ZERO, CN0_MAX_DBHZ),
    "carrier_hz": (ABOVE_ZERO, CARRIER_MAX_HZ),
    "elevation_deg": (-90.0, 90.0),
    "azimuth_deg": (-360.0, 360.0),
    "clock_bias_m": (-QUANTITY_MAX, QUANTITY_MAX),
    "clock_drift_mps": (-QUANTITY_MAX, QUANTITY_MAX),
    **dict.fromkeys(PLACE, (-DISTANCE_MAX_M, DISTANCE_MAX_M)),
    **dict.fromkeys(MOTION, (-MOTION_MAX_MPS, MOTION_MAX_MPS)),
}

Told = Mapping[str, float]
"""Numbers by the fields of RawSatellite; what is not told is not in it."""


def raw_satellite(
    system: str, prn: int, told: Told, *, line_of_sight: bool | None = None
) -> RawSatellite | None:
    """The satellite with what of its numbers can be; None where nothing was measured of it."""
    known = {
        name: number
        for name, number in told.items()
        if BOUNDS[name][0] <= number <= BOUNDS[name][1]
    }
    if known.get("pseudorange_m") == 0.0:
        del known["pseudorange_m"]
    if "pseudorange_m" not in known and "doppler_hz" not in known:
        return None
    if "azimuth_deg" in known:
        known["azimuth_deg"] %= 360.0
    if PLACE[0] in told or MOTION[0] in told:
        _check_place(known)
    return RawSatellite(system=system, prn=prn, line_of_sight=line_of_sight, **known)


def place_of(satellite: RawSatellite) -> Vector | None:
    """Where it is, in m, ECEF; None where that is not told."""
    if satellite.x_m is None or satellite.y_m is None or satellite.z_m is None:
        return None
    return Vector(satellite.x_m, satellite.y_m, satellite.z_m)


def _check_place(known: dict[str, float]) -> None:
    """Take out a place where no satellite can be, and a motion that is not whole or of no place."""
    place = [known.get(name, 0.0) for name in PLACE]
    is_whole = all(name in known for name in PLACE)
    if not (is_whole and DISTANCE_MIN_M <= Vector(*place).length <= DISTANCE_MAX_M):
        for name in (*PLACE, *MOTION):
            known.pop(name, None)
    elif not all(name in known for name in MOTION):
        for name in MOTION:
            known.pop(name, None)
