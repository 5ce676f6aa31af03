"""Instants as people and programs write them into tables."""

import datetime as dt
import re
import zoneinfo

from wayline.csv_file import number_of
from wayline.errors import InputError
from wayline.messages import EARLIEST_NS, LATEST_NS

MILLISECONDS_FROM = 1e11
"""Plain numbers from here on are Unix time in milliseconds, below in seconds."""
REPEATED_NS = 2 * 3_600 * 1_000_000_000
"""A row earlier by more is not one of the hour that the end of summer time repeats."""
DAY_FIRST = re.compile(r"^(\d\d)\.(\d\d)\.(\d{4})(?!\d)")


def zone_of(name: str, where: str) -> zoneinfo.ZoneInfo:
    """The time zone of that name; `where` names the table that asks. Raises InputError."""
    try:
        return zoneinfo.ZoneInfo(name)
    except (zoneinfo.ZoneInfoNotFoundError, ValueError, OSError):
        mend = 'give an IANA name such as "America/New_York"'
        raise InputError(where, f"unknown timezone {name!r}", mend) from None


def table_time_ns(text: str, zone: zoneinfo.ZoneInfo, last_ns: int) -> int | None:
    """A cell as Unix time in ns; None where it is none, or none of a receiver's days.

    It is ISO 8601 (with `T` or a space, also 2026/11/22 and 22.11.2026 for the day), local to
    `zone` where it carries no offset, or Unix time in seconds or milliseconds. `last_ns` is the
    row's before: of the hour that the end of summer time repeats an earlier time is the second one.
    """
    unix = number_of(text)
    if unix is not None:
        per_unit = 1_000 if unix >= MILLISECONDS_FROM else 1_000_000
        return _plausible(round(unix * per_unit) * 1_000)
    try:
        written = dt.datetime.fromisoformat(_iso(text))
    except ValueError:
        return None
    if written.tzinfo is not None:
        return _plausible(_unix_ns(written))
    t_ns = _unix_ns(written.replace(tzinfo=zone))
    if 0 < last_ns - t_ns < REPEATED_NS:
        t_ns = max(t_ns, _unix_ns(written.replace(tzinfo=zone, fold=1)))
    return _plausible(t_ns)


def _iso(text: str) -> str:
    """Year first or, with dots, day first; what has the month first is not told from either."""
    return DAY_FIRST.sub(r"\3-\2-\1", text.replace("/", "-"), count=1)


def _plausible(t_ns: int) -> int | None:
    return t_ns if EARLIEST_NS <= t_ns <= LATEST_NS else None


def _unix_ns(instant: dt.datetime) -> int:
    since = instant - dt.datetime(1970, 1, 1, tzinfo=dt.UTC)
    return (since.days * 86_400 + since.seconds) * 1_000_000_000 + since.microseconds * 1_000
