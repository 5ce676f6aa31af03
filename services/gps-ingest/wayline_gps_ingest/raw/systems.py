"""Pure: satellite systems by the names that sources have for them."""

import re

SYSTEMS_BY_LETTER = {
    "G": "gps",
    "R": "glonass",
    "E": "galileo",
    "C": "beidou",
    "J": "qzss",
    "S": "sbas",
    "I": "navic",
}
"""RINEX 3, section 3.5."""
SYSTEMS_BY_NAME = {
    **{name: name for name in SYSTEMS_BY_LETTER.values()},
    "glo": "glonass",
    "gal": "galileo",
    "bds": "beidou",
    "compass": "beidou",
    "qzs": "qzss",
    "irnss": "navic",
}
NUMBERED = re.compile(r"([A-Za-z])\s*(\d{1,4})")
PLAIN = re.compile(r"(\d{1,4})(?:\.0*)?")


def system_of(name: str) -> str | None:
    """A system by its name or RINEX's letter; None where it is not known."""
    return SYSTEMS_BY_LETTER.get(name.upper()) or SYSTEMS_BY_NAME.get(name.lower())


def satellite_of(system: str | None, prn: str) -> tuple[str, int] | None:
    """System and number of a satellite named in one text (G12) or two; None where it is none.

    Without a system a bare number is one of GPS.
    """
    numbered, plain = NUMBERED.fullmatch(prn), PLAIN.fullmatch(prn)
    if numbered:
        told, number = numbered.groups()
    elif plain:
        told, number = "G", plain[1]
    else:
        return None
    name = system_of(system or told)
    return (name, int(number)) if name else None
