"""Reads a CSV of a transit system's position reports, by the mapping of an `[[avl]]` table."""

import datetime as dt
import re
import zoneinfo
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from wayline.csv_file import CsvFile, Row, number_of
from wayline.drive import AvlSource
from wayline.errors import InputError
from wayline.inputs import PositionReport
from wayline.messages import EARLIEST_NS, LATEST_NS

MILLISECONDS_FROM = 1e11
"""Plain numbers from here on are Unix time in milliseconds, below in seconds."""
DAY_FIRST = re.compile(r"^(\d\d)\.(\d\d)\.(\d{4})(?!\d)")


def read_reports(source: AvlSource) -> Iterator[PositionReport | None]:
    """The rows in order; a row without a readable time and position is None, for counting.

    The file is CSV as `wayline.csv_file` reads it. Times are ISO 8601 (with `T` or a space, also
    2026/11/22 and 22.11.2026 for the day), local to the source's timezone where they carry no
    offset, or Unix time in seconds or milliseconds. In the hour that the end of summer time
    repeats, a time earlier than the row before is the second one.

    Raises InputError for a file that cannot be read, an unknown timezone, no rows, or a mapped
    column that is not in the header.
    """
    zone = _zone(source)
    file = CsvFile(Path(source.path))
    rows = file.rows()
    columns = _columns(source, next(rows, Row(1, [])).cells)
    last_ns = 0
    for row in rows:
        report = _report(columns.of(row), zone, last_ns)
        last_ns = report.t_ns if report else last_ns
        yield report
    if file.is_broken:
        yield None


def _zone(source: AvlSource) -> zoneinfo.ZoneInfo:
    try:
        return zoneinfo.ZoneInfo(source.timezone)
    except (zoneinfo.ZoneInfoNotFoundError, ValueError, OSError):
        raise InputError(
            f"[[avl]] {source.path}",
            f"unknown timezone {source.timezone!r}",
            'give an IANA name such as "America/New_York"',
        ) from None


class _Cells(NamedTuple):
    """The mapped cells of a row; empty where there is none."""

    time: str
    lat_deg: str
    lon_deg: str
    heading_deg: str
    speed_mps: str
    assignment: str


class _Places(NamedTuple):
    """Where the mapped columns are; None where one is not mapped."""

    time: int
    lat_deg: int
    lon_deg: int
    heading_deg: int | None
    speed_mps: int | None
    assignment: int | None

    def of(self, row: Row) -> _Cells:
        """The mapped cells of a row."""
        count = len(row.cells)
        return _Cells(*(row.cells[at] if at is not None and at < count else "" for at in self))


def _columns(source: AvlSource, header: list[str]) -> _Places:
    columns = source.columns

    def place(quantity: str, name: str) -> int:
        if name.strip() not in header:
            raise InputError(
                source.path,
                f"no column {name} for {quantity}",
                f"name one of its columns: {', '.join(header) or 'none, the file is empty'}",
            )
        return header.index(name.strip())

    heading, speed, assignment = columns.heading_deg, columns.speed_mps, columns.assignment
    return _Places(
        place("time", columns.time),
        place("lat_deg", columns.lat_deg),
        place("lon_deg", columns.lon_deg),
        None if heading is None else place("heading_deg", heading),
        None if speed is None else place("speed_mps", speed),
        None if assignment is None else place("assignment", assignment),
    )


def _report(cells: _Cells, zone: zoneinfo.ZoneInfo, last_ns: int) -> PositionReport | None:
    t_ns = _time_ns(cells.time, zone, last_ns)
    lat_deg, lon_deg = number_of(cells.lat_deg), number_of(cells.lon_deg)
    if t_ns is None or lat_deg is None or lon_deg is None:
        return None
    return PositionReport(
        t_ns=t_ns,
        lat_deg=lat_deg,
        lon_deg=lon_deg,
        heading_deg=number_of(cells.heading_deg),
        speed_mps=number_of(cells.speed_mps),
        assignment=cells.assignment or None,
    )


def _time_ns(text: str, zone: zoneinfo.ZoneInfo, last_ns: int) -> int | None:
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
    if t_ns < last_ns:
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
