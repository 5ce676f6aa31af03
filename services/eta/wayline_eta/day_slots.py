"""Pure: which times of which days are driven alike."""

import datetime as dt
from zoneinfo import ZoneInfo

SLOT_MINUTES = 30
SATURDAY = 5


def slot_of(t_ns: int, zone: ZoneInfo) -> tuple[str, int]:
    """The class of a local day (weekday, saturday, sunday), and the half hour within it."""
    local = dt.datetime.fromtimestamp(t_ns // 1_000_000_000, zone)
    day = local.weekday()
    name = "weekday" if day < SATURDAY else "saturday" if day == SATURDAY else "sunday"
    return name, (local.hour * 60 + local.minute) // SLOT_MINUTES
