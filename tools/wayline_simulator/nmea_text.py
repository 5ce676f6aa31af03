"""Pure: numbers as NMEA 0183 writes them, and the sentence around them."""

import datetime as dt
import math
from functools import lru_cache

import pynmea2

KNOTS_PER_MPS = 3600.0 / 1852.0
KMPH_PER_MPS = 3.6


def sentence(body: str) -> bytes:
    """A body between `$` and its checksum."""
    return f"${body}*{pynmea2.NMEASentence.checksum(body):02X}".encode("ascii")


def utc(unix_s: float) -> tuple[str, dt.date]:
    """`hhmmss.ss` and the day; `unix_s` has at most two decimals."""
    seconds, hundredths = divmod(round(unix_s * 100.0), 100)
    day, second = divmod(seconds, 86_400)
    minutes, second = divmod(second, 60)
    return f"{minutes // 60:02d}{minutes % 60:02d}{second:02d}.{hundredths:02d}", _date(day)


@lru_cache(maxsize=4)
def _date(day: int) -> dt.date:
    return dt.date(1970, 1, 1) + dt.timedelta(days=day)


def place(lat_deg: float, lon_deg: float, decimals: int) -> str:
    """`ddmm.mmmmm,N,dddmm.mmmmm,E`"""
    lat, lon = _angle(lat_deg, 2, decimals), _angle(lon_deg, 3, decimals)
    return f"{lat},{'S' if lat_deg < 0.0 else 'N'},{lon},{'W' if lon_deg < 0.0 else 'E'}"


def _angle(angle_deg: float, degree_digits: int, decimals: int) -> str:
    # rounded before it is split, so that no minutes become 60
    units = 10**decimals
    degrees, rest = divmod(round(abs(angle_deg) * 60.0 * units), 60 * units)
    minutes, fraction = divmod(rest, units)
    return f"{degrees:0{degree_digits}d}{minutes:02d}.{fraction:0{decimals}d}"


def course(course_deg: float) -> str:
    """Two decimals below 360, or nothing where it is nan."""
    return "" if math.isnan(course_deg) else f"{round(course_deg, 2) % 360.0:.2f}"


def knots(speed_mps: float) -> str:
    """Two decimals, steps of 5 mm/s."""
    return f"{speed_mps * KNOTS_PER_MPS:.2f}"
