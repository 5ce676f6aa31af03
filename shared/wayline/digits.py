"""Pure: numbers with the digits that mean something, by the unit in which their name ends."""

from functools import lru_cache
from typing import Any

import msgspec

PLACE_DIGITS = 7
"""Of a degree of latitude or longitude: a centimetre."""
PLACES = ("lat_deg", "lon_deg", "coordinates")
"""Ends of names: a trip has a `start_lat_deg`."""
DIGITS = {"m": 2, "mps": 2, "deg": 2, "degps": 3, "pct": 3, "s": 2, "ms": 2, "hz": 2}
OTHER_DIGITS = 4
"""Of shares, ratios and what has no unit."""


def rounded(content: Any) -> Any:
    """A Struct, or what msgspec can encode, as plain values with rounded numbers."""
    return _rounded(msgspec.to_builtins(content, builtin_types=(bytes,)), OTHER_DIGITS)


def _rounded(value: Any, digits: int) -> Any:
    if isinstance(value, float):
        return round(value, digits)
    if isinstance(value, dict):
        return {name: _rounded(member, _digits_of(name)) for name, member in value.items()}
    if isinstance(value, list | tuple):
        return [_rounded(member, digits) for member in value]
    return value


@lru_cache(maxsize=1024)
def _digits_of(name: str) -> int:
    if name.endswith(PLACES):
        return PLACE_DIGITS
    return DIGITS.get(name.rpartition("_")[2], OTHER_DIGITS)
