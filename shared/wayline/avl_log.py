"""Reads a CSV of a transit system's position reports, by the mapping of an `[[avl]]` table."""

import csv
import datetime as dt
import math
import zoneinfo
from collections.abc import Iterator, Sequence
from pathlib import Path

from wayline.drive import AvlColumns, AvlSource
from wayline.errors import InputError
from wayline.inputs import PositionReport

MILLISECONDS_FROM = 1e11
"""Plain numbers from here on are Unix time in milliseconds, below in seconds."""
LATEST_NS = 4_102_444_800 * 1_000_000_000
"""The year 2100; later times are none."""


def read_reports(source: AvlSource) -> Iterator[PositionReport | None]:
    """The rows in order; a row without a readable time and position is None, for counting.

    Times are ISO 8601 (with `T` or a space), local to the source's timezone where they carry no
    offset, or Unix time in seconds or milliseconds. In the hour that the end of summer time
    repeats, a time earlier than the row before is the second one.

    Raises InputError for a file that cannot be read, an unknown timezone, no rows, or a mapped
    column that is not in the header.
    """
    zone = _zone(source)
    path = Path(source.path)
    try:
        with path.open(newline="", encoding="utf-8-sig", errors="replace") as file:
            rows = csv.DictReader(file)
            _check_header(source, rows.fieldnames or ())
            yield from _reports(rows, source.columns, zone)
    except OSError as error:
        raise InputError(
            str(path), f"cannot be read ({error.strerror})", "check the path"
        ) from None
    except csv.Error as error:
        raise InputError(str(path), f"is not CSV ({error})", "check the file") from None


def _reports(
    rows: "csv.DictReader[str]", columns: AvlColumns, zone: zoneinfo.ZoneInfo
) -> Iterator[PositionReport | None]:
    last_ns = 0
    for row in rows:
        report = _report(row, columns, zone, last_ns)
        last_ns = report.t_ns if report else last_ns
        yield report


def _zone(source: AvlSource) -> zoneinfo.ZoneInfo:
    try:
        return zoneinfo.ZoneInfo(source.timezone)
    except (zoneinfo.ZoneInfoNotFoundError, ValueError, OSError):
        raise InputError(
            f"[[avl]] {source.path}",
            f"unknown timezone {source.timezone!r}",
            'give an IANA name such as "America/New_York"',
        ) from None


def _check_header(source: AvlSource, header: Sequence[str]) -> None:
    columns = source.columns
    mapped = {
        "time": columns.time,
        "lat_deg": columns.lat_deg,
        "lon_deg": columns.lon_deg,
        "heading_deg": columns.heading_deg,
        "speed_mps": columns.speed_mps,
    }
    for quantity, name in mapped.items():
        if name is not None and name not in header:
            raise InputError(
                source.path,
                f"no column {name} for {quantity}",
                f"name one of its columns: {', '.join(header) or 'none, the file is empty'}",
            )


def _report(
    row: dict[str, str], columns: AvlColumns, zone: zoneinfo.ZoneInfo, last_ns: int
) -> PositionReport | None:
    t_ns = _time_ns(row[columns.time] or "", zone, last_ns)
    lat_deg, lon_deg = _number(row[columns.lat_deg]), _number(row[columns.lon_deg])
    if t_ns is None or lat_deg is None or lon_deg is None:
        return None
    return PositionReport(
        t_ns=t_ns,
        lat_deg=lat_deg,
        lon_deg=lon_deg,
        heading_deg=_number(row[columns.heading_deg]) if columns.heading_deg else None,
        speed_mps=_number(row[columns.speed_mps]) if columns.speed_mps else None,
    )


def _number(text: str | None) -> float | None:
    try:
        value = float(text or "")
    except ValueError:
        return None
    return value if math.isfinite(value) else None


def _time_ns(text: str, zone: zoneinfo.ZoneInfo, last_ns: int) -> int | None:
    unix = _number(text)
    if unix is not None:
        per_unit = 1_000 if unix >= MILLISECONDS_FROM else 1_000_000
        return _plausible(round(unix * per_unit) * 1_000)
    try:
        written = dt.datetime.fromisoformat(text.strip())
    except ValueError:
        return None
    if written.tzinfo is not None:
        return _plausible(_unix_ns(written))
    t_ns = _unix_ns(written.replace(tzinfo=zone))
    if t_ns < last_ns:
        t_ns = max(t_ns, _unix_ns(written.replace(tzinfo=zone, fold=1)))
    return _plausible(t_ns)


def _plausible(t_ns: int) -> int | None:
    return t_ns if 0 <= t_ns < LATEST_NS else None


def _unix_ns(instant: dt.datetime) -> int:
    since = instant - dt.datetime(1970, 1, 1, tzinfo=dt.UTC)
    return (since.days * 86_400 + since.seconds) * 1_000_000_000 + since.microseconds * 1_000
