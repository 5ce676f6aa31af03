"""Pure: a position report of a transit system as a fix."""

from wayline.inputs import PositionReport
from wayline.messages import SPEED_MAX_MPS, TEXT_MAX, GpsFix


def fix_of_report(report: PositionReport) -> GpsFix | None:
    """The report as a fix not yet stamped (t_ns 0), or None where its position cannot be one.

    0 degrees north and east is what such systems write for a vehicle that they have lost.
    """
    in_range = abs(report.lat_deg) <= 90.0 and abs(report.lon_deg) <= 180.0
    if not in_range or (report.lat_deg == 0.0 and report.lon_deg == 0.0):
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
        assignment=_text(report.assignment),
    )


def _text(text: str | None) -> str | None:
    return text if text and len(text) <= TEXT_MAX else None


def _speed_mps(speed_mps: float | None) -> float | None:
    return speed_mps if speed_mps is not None and 0.0 <= speed_mps <= SPEED_MAX_MPS else None


def _course_deg(heading_deg: float | None) -> float | None:
    if heading_deg is None or not 0.0 <= heading_deg <= 360.0:
        return None
    return heading_deg % 360.0
