"""Pure: times and dates as feeds write them."""

import datetime as dt
import re

TIME = re.compile(r"(\d{1,3}):(\d{1,2}):(\d{1,2})(?:\.\d*)?|(\d{1,3}):(\d{1,2})")
DATE = re.compile(r"(\d{4})-?(\d\d)-?(\d\d)")


def seconds_of_clock(text: str) -> int | None:
    """Seconds of a time such as `7:05:00`, which may go past 24 hours; None for anything else."""
    if not (parts := TIME.fullmatch(text.strip())):
        return None
    hours, minutes, seconds = (*parts.groups()[:3],) if parts[1] else (parts[4], parts[5], "0")
    if int(minutes) > 59 or int(seconds) > 59:
        return None
    return 3600 * int(hours) + 60 * int(minutes) + int(seconds)


def clock_of_seconds(seconds: float) -> str:
    """The inverse of `seconds_of_clock`, to the second."""
    whole = round(seconds)
    return f"{whole // 3600:02d}:{whole // 60 % 60:02d}:{whole % 60:02d}"


def ordinal_of_date(text: str) -> int | None:
    """The ordinal of a date such as `20260131`; None for anything else."""
    if not (parts := DATE.fullmatch(text.strip())):
        return None
    try:
        return dt.date(*(int(part) for part in parts.groups())).toordinal()
    except ValueError:
        return None
