"""Pure: which times of which days are driven alike."""

import datetime as dt
from functools import lru_cache
from zoneinfo import ZoneInfo

SLOT_MINUTES = 30
SATURDAY = 5
QUARTER_S = 900
"""Clocks of all zones are whole quarters of an hour apart."""
SECOND_NS = 1_000_000_000


def slot_of(t_ns: int, zone: ZoneInfo) -> tuple[str, int]:
    """The class of a local day (weekday, saturday, sunday), and the half hour within it."""
    return _slot(t_ns // (QUARTER_S * SECOND_NS), zone)


@lru_cache(maxsize=1024)
def _slot(quarter: int, zone: ZoneInfo) -> tuple[str, int]:
    local = dt.datetime.fromtimestamp(quarter * QUARTER_S, zone)
    day = local.weekday()
    name = "weekday" if day < SATURDAY else "saturday" if day == SATURDAY else "sunday"
    return name, (local.hour * 60 + local.minute) // SLOT_MINUTES
