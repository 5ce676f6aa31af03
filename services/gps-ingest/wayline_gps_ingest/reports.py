"""Pure: a position report of a transit system as a fix."""

from wayline.inputs import PositionReport
from wayline.messages import SPEED_MAX_MPS, TEXT_MAX, GpsFix

SATELLITES_MAX = 255


def fix_of_report(report: PositionReport) -> GpsFix | None:
    """The report as a fix not yet stamped (t_ns 0), or None where its position cannot be one."""
    if not has_place(report):
        return None
    return GpsFix(
        t_ns=0,
        valid=True,
        lat_deg=report.lat_deg,
        lon_deg=report.lon_deg,
        speed_mps=_speed_mps(report.speed_mps),
        course_deg=_course_deg(report.heading_deg),
        mode=2,
        fix="gps",
        satellites=_count(report.satellites),
        hdop=_dilution(report.hdop),
        pdop=_dilution(report.pdop),
        assignment=_text(report.assignment),
    )


def has_place(report: PositionReport) -> bool:
    """Whether a position can be one.

    0 degrees north and east is what such systems write for a vehicle that they have lost.
    """
    in_range = abs(report.lat_deg) <= 90.0 and abs(report.lon_deg) <= 180.0
    return in_range and not (report.lat_deg == 0.0 and report.lon_deg == 0.0)


def _speed_mps(speed_mps: float | None) -> float | None:
    return speed_mps if speed_mps is not None and 0.0 <= speed_mps <= SPEED_MAX_MPS else None


def _course_deg(heading_deg: float | None) -> float | None:
    if heading_deg is None or not 0.0 <= heading_deg <= 360.0:
        return None
    return heading_deg % 360.0


def _count(satellites: float | None) -> int | None:
    if satellites is None or not 0.0 <= satellites <= SATELLITES_MAX:
        return None
    return int(satellites)


def _dilution(told: float | None) -> float | None:
    """No constellation has a dilution of 0: that is what is written for unknown."""
    return told if told is not None and told > 0.0 else None


def _text(told: str | None) -> str | None:
    return told if told and len(told) <= TEXT_MAX else None
