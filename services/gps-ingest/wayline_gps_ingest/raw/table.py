"""Reads raw measurements from a CSV, one satellite a row, by the mapping of a `[[raw]]` table."""

import zoneinfo
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import msgspec

from wayline.csv_file import CsvFile, Row, number_of, place_in
from wayline.drive import AvlColumn, Column, RawColumns, RawSource
from wayline.errors import InputError
from wayline.messages import RawSatellite
from wayline.table_time import table_time_ns, zone_of
from wayline_gps_ingest.raw.ephemerides import Placing
from wayline_gps_ingest.raw.epoch import RawEpoch
from wayline_gps_ingest.raw.gathering import gathered
from wayline_gps_ingest.raw.measured import raw_satellite
from wayline_gps_ingest.raw.systems import satellite_of

TEXTS = ("time", "system", "prn", "line_of_sight")
NUMBERS = tuple(name for name in RawColumns.__struct_fields__ if name not in TEXTS)
SEEN = {"1": True, "true": True, "los": True, "0": False, "false": False, "nlos": False}


class RawTable:
    """A table, read once, as epochs in order of time.

    It is CSV as `wayline.csv_file` reads it, its times as `wayline.table_time` does. `placing`
    gives satellites the places that the table does not tell. Rows are counted in `faults` where
    they are left out: `row` (no time or no satellite in it), `empty` (nothing measured), `late`,
    `twice`; `broken` is a packed file that could not be unpacked to its end. Iterating raises
    InputError for a file that cannot be read, an unknown timezone, or a named column that is not
    in the header.
    """

    def __init__(
        self, source: RawSource, columns: RawColumns, placing: Placing | None = None
    ) -> None:
        self._source = source
        self._columns = columns
        self._placing = placing
        self.faults: Counter[str] = Counter()
        self._rows = 0

    def __iter__(self) -> Iterator[RawEpoch]:
        placing = self._placing
        for epoch in gathered(self._measured(), self.faults):
            if placing is None:
                yield epoch
            else:
                satellites = placing.satellites(epoch.t_ns, epoch.satellites)
                yield msgspec.structs.replace(epoch, satellites=satellites)

    def nothing(self) -> InputError:
        """Why it holds no epoch."""
        counted = ", ".join(f"{times:,} {why}" for why, times in sorted(self.faults.items()))
        what = f"none of its {self._rows:,} rows measures a satellite ({counted or 'it is empty'})"
        mend = "check its columns: time ISO 8601 or Unix seconds, prn, pseudorange_m or doppler_hz"
        return InputError(self._source.path, what, mend)

    def _measured(self) -> Iterator[tuple[int, RawSatellite]]:
        source = self._source
        zone = zone_of(source.timezone, f"[[raw]] {source.path}")
        file = CsvFile(Path(source.path))
        rows = file.rows()
        places = _places(self._columns, next(rows, Row(1, [])).cells, source.path)
        last_ns = 0
        for row in rows:
            self._rows += 1
            read = places.read(row, zone, last_ns)
            if isinstance(read, str):
                self.faults[read] += 1
                continue
            last_ns = read[0]
            yield read
        if file.is_broken:
            self.faults["broken"] += 1


class _Places(NamedTuple):
    """Where in a row what is mapped stands."""

    time: int
    prn: int
    system: int | None
    line_of_sight: int | None
    numbers: dict[str, tuple[int, float]]
    """By field: the column, and what its numbers are multiplied by."""

    def read(
        self, row: Row, zone: zoneinfo.ZoneInfo, last_ns: int
    ) -> tuple[int, RawSatellite] | str:
        """When a row is of and its satellite, or the fault for which it is left out."""
        t_ns = table_time_ns(_cell(row, self.time), zone, last_ns)
        named = satellite_of(_cell(row, self.system) or None, _cell(row, self.prn))
        if t_ns is None or named is None:
            return "row"
        told = {
            name: number * scale
            for name, (at, scale) in self.numbers.items()
            if (number := number_of(_cell(row, at))) is not None
        }
        seen = SEEN.get(_cell(row, self.line_of_sight).lower())
        satellite = raw_satellite(*named, told, line_of_sight=seen)
        return "empty" if satellite is None else (t_ns, satellite)


def _cell(row: Row, at: int | None) -> str:
    """Empty where there is none."""
    return row.cells[at] if at is not None and at < len(row.cells) else ""


def _places(columns: RawColumns, header: list[str], where: str) -> _Places:
    """Where the mapped columns stand. Raises InputError for one that the header does not have."""

    def text(name: str) -> int | None:
        column: str | None = getattr(columns, name)
        return None if column is None else place_in(header, column, name, where)

    numbers: dict[str, tuple[int, float]] = {}
    for name in NUMBERS:
        column: Column | None = getattr(columns, name)
        if isinstance(column, AvlColumn):
            numbers[name] = place_in(header, column.name, name, where), column.scale
        elif column is not None:
            numbers[name] = place_in(header, column, name, where), 1.0
    return _Places(
        time=place_in(header, columns.time, "time", where),
        prn=place_in(header, columns.prn, "prn", where),
        system=text("system"),
        line_of_sight=text("line_of_sight"),
        numbers=numbers,
    )
