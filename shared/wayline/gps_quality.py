"""Pure: how far a fix can be trusted before any filter has seen it (papers/003)."""

from wayline.messages import FixKind, GpsFix
from wayline.tuning import Tuning

KIND_SHARE: dict[FixKind, float] = {"dgps": 0.5, "rtk_float": 0.15, "rtk_fixed": 0.02}
"""Of the range error of an uncorrected fix: what corrections leave of it. 3 m become 1.5 m with
satellite-based ones, half a metre with a floating carrier solution, 6 cm with a fixed one."""


def is_good(fix: GpsFix, tuning: Tuning) -> bool:
    """At least 4 satellites and PDOP at most 8, where the receiver tells (papers/003).

    A receiver that tells neither is given the benefit of the doubt.
    """
    enough = fix.satellites is None or fix.satellites >= tuning.good_satellites_min
    well_spread = fix.pdop is None or fix.pdop <= tuning.good_pdop_max
    return enough and well_spread


def horizontal_std_m(fix: GpsFix, tuning: Tuning) -> float:
    """One sigma per axis of a fix's position: its own where reported, else from HDOP, floored."""
    share = KIND_SHARE.get(fix.fix, 1.0)
    floor_m = share * tuning.gps_position_std_floor_m
    if fix.h_std_m is not None:
        std_m = max(fix.h_std_m, floor_m)
    elif fix.hdop is not None and fix.hdop > 0.0:
        std_m = max(fix.hdop * share * tuning.gps_range_std_m, floor_m)
    else:
        std_m = share * tuning.gps_position_std_m
    return std_m if is_good(fix, tuning) else std_m * tuning.bad_gps_factor


def has_altitude(fix: GpsFix) -> bool:
    """Whether a fix tells an altitude of its own; a 2-D fix holds the one before it."""
    return fix.valid and fix.alt_m is not None and fix.mode != 2


def altitude_std_m(fix: GpsFix, tuning: Tuning) -> float:
    """One sigma of a fix's altitude: its own where reported, else from VDOP or the horizontal."""
    if fix.v_std_m is not None:
        std_m = max(fix.v_std_m, tuning.gps_altitude_std_floor_m)
    elif fix.vdop is not None and fix.vdop > 0.0:
        std_m = max(fix.vdop * tuning.gps_range_std_m, tuning.gps_altitude_std_floor_m)
    else:
        std_m = horizontal_std_m(fix, tuning) * tuning.gps_vertical_factor
        return max(std_m, tuning.gps_altitude_std_floor_m)
    return std_m if is_good(fix, tuning) else std_m * tuning.bad_gps_factor
