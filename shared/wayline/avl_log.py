"""Reads a CSV of a transit system's position reports, by the mapping of an `[[avl]]` table."""

import zoneinfo
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from wayline.csv_file import CsvFile, Row, number_of, place_in
from wayline.drive import AvlColumn, AvlSource, Column
from wayline.errors import InputError
from wayline.inputs import PositionReport
from wayline.table_time import table_time_ns, zone_of

NUMBERS = ("lat_deg", "lon_deg", "heading_deg", "speed_mps", "satellites", "hdop", "pdop")


class ReportLog:
    """A table, read once: its rows in order, each None that has no readable time and position.

    The file is CSV as `wayline.csv_file` reads it. Times are ISO 8601 (with `T` or a space, also
    2026/11/22 and 22.11.2026 for the day), local to the source's timezone where they carry no
    offset, or Unix time in seconds or milliseconds. In the hour that the end of summer time
    repeats, a time earlier than the row before is the second one.

    Iterating raises InputError for a file that cannot be read, an unknown timezone, no rows, or a
    named column that is not in the header.
    """

    def __init__(self, source: AvlSource) -> None:
        self._source = source
        self.left_out = 0
        """Rows with other values than `where` asks for."""

    def __iter__(self) -> Iterator[PositionReport | None]:
        source = self._source
        zone = zone_of(source.timezone, f"[[avl]] {source.path}")
        file = CsvFile(Path(source.path))
        rows = file.rows()
        places = _places(source, next(rows, Row(1, [])).cells)
        last_ns = 0
        for row in rows:
            if not places.takes(row):
                self.left_out += 1
                continue
            report = _report(places, row, zone, last_ns)
            last_ns = report.t_ns if report else last_ns
            yield report
        if file.is_broken:
            yield None


def read_reports(source: AvlSource) -> Iterator[PositionReport | None]:
    """The rows of a table, as `ReportLog` reads them. Raises InputError."""
    yield from ReportLog(source)


class _Places(NamedTuple):
    """Where in a row what is mapped stands."""

    time: int
    numbers: dict[str, tuple[int, float]]
    """By quantity: the column, and what its numbers are multiplied by."""
    assignment: int | None
    where: list[tuple[int, str]]

    def takes(self, row: Row) -> bool:
        """Whether a row has the values that are asked for."""
        return all(_cell(row, at) == value for at, value in self.where)


def _cell(row: Row, at: int | None) -> str:
    """Empty where there is none."""
    return row.cells[at] if at is not None and at < len(row.cells) else ""


def _places(source: AvlSource, header: list[str]) -> _Places:
    columns = source.columns
    if columns is None:
        raise InputError(source.path, "no columns are named", "add columns to its [[avl]]")

    def place(name: str, purpose: str) -> int:
        return place_in(header, name, purpose, source.path)

    time = place(columns.time, "time")
    numbers: dict[str, tuple[int, float]] = {}
    for quantity in NUMBERS:
        column: Column | None = getattr(columns, quantity)
        if isinstance(column, AvlColumn):
            numbers[quantity] = place(column.name, quantity), column.scale
        elif column is not None:
            numbers[quantity] = place(column, quantity), 1.0
    return _Places(
        time,
        numbers,
        None if columns.assignment is None else place(columns.assignment, "assignment"),
        [(place(name, "where"), str(value)) for name, value in source.where.items()],
    )


def _report(
    places: _Places, row: Row, zone: zoneinfo.ZoneInfo, last_ns: int
) -> PositionReport | None:
    t_ns = table_time_ns(_cell(row, places.time), zone, last_ns)
    numbers = {
        name: number * scale
        for name, (at, scale) in places.numbers.items()
        if (number := number_of(_cell(row, at))) is not None
    }
    if t_ns is None or not {"lat_deg", "lon_deg"} <= numbers.keys():
        return None
    assignment = _cell(row, places.assignment) or None
    return PositionReport(t_ns=t_ns, assignment=assignment, received_ns=None, **numbers)
