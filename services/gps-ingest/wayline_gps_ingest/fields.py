"""Pure: text fields of NMEA 0183 sentences as numbers with units.

An empty field is None. What a receiver writes for "unknown" (`0NaN`) is None too. A time, date or
position that is there but cannot be one raises BadFieldError: its sentence is not to be trusted.
"""

import datetime as dt
from functools import lru_cache

SECOND_NS = 1_000_000_000
MPS_PER_KNOT = 1852.0 / 3600.0
MPS_PER_KMPH = 1.0 / 3.6
M_PER_FOOT = 0.3048
DILUTION_UNKNOWN = 99.0
NUMBER_MAX = 1e9
"""No quantity of any sentence comes near it; squares of it are still numbers."""


class BadFieldError(ValueError):
    """A field holds something that it cannot hold."""


def number(text: str) -> float | None:
    """A decimal number of any size that a receiver can mean, else None."""
    if not text:
        return None
    try:
        value = float(text)
    except ValueError:
        return None
    return value if abs(value) < NUMBER_MAX else None


def count(text: str) -> int | None:
    """A whole number >= 0, else None."""
    return int(text) if text.isdecimal() and text.isascii() and len(text) < 10 else None


def not_negative(text: str) -> float | None:
    """A number >= 0, else None."""
    value = number(text)
    return value if value is not None and value >= 0.0 else None


def positive(text: str) -> float | None:
    """A number > 0, else None: a deviation of 0 means that it is not known."""
    value = number(text)
    return value if value is not None and value > 0.0 else None


def dilution(text: str) -> float | None:
    """A dilution of precision, else None: 0 and 99.99 are what receivers write for unknown."""
    value = positive(text)
    return value if value is not None and value < DILUTION_UNKNOWN else None


def bearing_deg(text: str) -> float | None:
    """A bearing in 0 <= x < 360, else None."""
    value = number(text)
    if value is None or not 0.0 <= value <= 360.0:
        return None
    return 0.0 if value == 360.0 else value


# the sentences of an epoch tell one time and one position, and those of a day one date
@lru_cache(maxsize=256)
def time_of_day_ns(text: str) -> int | None:
    """`hhmmss` with any number of decimals in ns since midnight; second 60 is a leap second."""
    if not text:
        return None
    whole, _, fraction = text.partition(".")
    digits = whole + fraction
    if len(whole) != 6 or not (digits.isdecimal() and digits.isascii()):
        raise BadFieldError(text)
    hour, minute, second = int(whole[:2]), int(whole[2:4]), int(whole[4:])
    if hour > 23 or minute > 59 or second > 60:
        raise BadFieldError(text)
    nanoseconds = int(fraction[:9].ljust(9, "0")) if fraction else 0
    return (hour * 3600 + minute * 60 + second) * SECOND_NS + nanoseconds


@lru_cache(maxsize=256)
def date_of(day: str, month: str, year: str) -> dt.date | None:
    """A day from its three fields, 1980 (GPS time starts) to 2099; two digits end in 2079.

    Zeros are what a receiver writes that has not heard the date yet.
    """
    if not (day or month or year).strip("0"):
        return None
    numbers = count(day), count(month), count(year)
    if None in numbers:
        raise BadFieldError(f"{day} {month} {year}")
    day_number, month_number, year_number = (part or 0 for part in numbers)
    if len(year) == 2:
        year_number += 1900 if year_number >= 80 else 2000
    if not 1980 <= year_number < 2100:
        raise BadFieldError(year)
    try:
        return dt.date(year_number, month_number, day_number)
    except ValueError:
        raise BadFieldError(f"{day} {month} {year}") from None


def latitude_deg(text: str, hemisphere: str) -> float | None:
    """`ddmm.mmm` and N or S in degrees, north positive."""
    return _angle_deg(text, hemisphere, "NS", 90.0)


def longitude_deg(text: str, hemisphere: str) -> float | None:
    """`dddmm.mmm` and E or W in degrees, east positive."""
    return _angle_deg(text, hemisphere, "EW", 180.0)


@lru_cache(maxsize=256)
def _angle_deg(text: str, hemisphere: str, signs: str, limit_deg: float) -> float | None:
    if not text:
        return None
    value = number(text)
    if value is None or value < 0.0 or len(hemisphere) != 1 or hemisphere not in signs:
        raise BadFieldError(f"{text} {hemisphere}")
    degrees = value // 100.0
    minutes = value - degrees * 100.0
    angle_deg = degrees + minutes / 60.0
    # 60 minutes are what is written for 59.99999 with fewer decimals
    if minutes > 60.0 or angle_deg > limit_deg:
        raise BadFieldError(text)
    return angle_deg if hemisphere == signs[0] else -angle_deg
