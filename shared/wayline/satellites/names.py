"""Pure: satellites' names, as RINEX has them."""

LETTERS = {
    "gps": "G",
    "glonass": "R",
    "galileo": "E",
    "beidou": "C",
    "qzss": "J",
    "sbas": "S",
    "navic": "I",
}
"""By system."""


def name_of(system: str, prn: int) -> str:
    """G12; of a system that RINEX does not know its own name stands before the number."""
    return f"{LETTERS.get(system, system)}{prn}"
