"""Opens a GTFS feed, a folder or a zip file, as tables of text, however it was packed.

A table's columns are text without blanks around them, `row` is the line of the file. Names of
files count whatever their letters, at the top or in the folder that was packed with them.
"""

import csv
import hashlib
import io
import re
import struct
import zipfile
import zlib
from collections.abc import Iterator
from pathlib import Path

import polars as pl

from wayline.errors import InputError
from wayline.log_file import decoded
from wayline.timetable.notes import Notes

ROW = "row"
ZIP_DAMAGE = (
    OSError, EOFError, ValueError, RuntimeError, struct.error, zlib.error, zipfile.BadZipFile,
)  # fmt: skip
"""What zipfile raises for files that are damaged, encrypted or newer than it."""
QUOTED_AFTER_BLANK = (b', "', b'" ,', b'\n "')
"""In CSV that Python's own reader understands and faster ones do not."""
BLANKS = (b" ", b"\t", b"\xc2\xa0")
TABLES = (
    "agency", "routes", "stops", "trips", "stop_times", "calendar", "calendar_dates", "shapes",
    "frequencies",
)  # fmt: skip
REQUIRED = {
    "trips": ("trip_id", "route_id"),
    "stops": ("stop_id", "stop_lat", "stop_lon"),
    "stop_times": ("trip_id", "stop_id"),
    "shapes": ("shape_id", "shape_pt_lat", "shape_pt_lon"),
    "calendar": ("service_id", "start_date", "end_date"),
    "calendar_dates": ("service_id", "date", "exception_type"),
    "frequencies": ("trip_id", "start_time", "end_time", "headway_secs"),
    "routes": ("route_id",),
    "agency": ("agency_timezone",),
}
"""Columns without which a table is of no use."""


class FeedFiles:
    """The files of a feed. Raises InputError where there is none, or it is damaged."""

    def __init__(self, path: Path, notes: Notes) -> None:
        self.path, self._notes = path, notes
        if not path.exists():
            raise InputError(str(path), "no such file", "name a GTFS folder or zip file")
        if not path.is_dir() and not zipfile.is_zipfile(path):
            raise InputError(str(path), "is not a GTFS feed", "name a GTFS folder or zip file")
        try:
            self._members = _members(path)
        except ZIP_DAMAGE as error:
            raise self._damaged(error) from None

    def fingerprint(self) -> str:
        """A hash of all that its tables hold, whatever they are packed in."""
        digest = hashlib.sha256()
        for table in TABLES:
            content = self._content(table)
            digest.update(f"{table} {len(content)}\n".encode())
            digest.update(content)
        return digest.hexdigest()

    def table(self, name: str) -> pl.DataFrame:
        """A table by its name; of a missing one no rows and the columns that it must have.

        A table that lacks a column which it must have is noted and counts as missing.
        """
        content = self._content(name)
        frame = _frame(content)
        if frame.is_empty():
            return _none_of(name)
        if missing := [column for column in REQUIRED[name] if column not in frame.columns]:
            self._notes.add("unusable", f"{name}.txt", f"has no column {missing[0]}")
            return _none_of(name)
        return frame

    def _content(self, table: str) -> bytes:
        member = self._members.get(f"{table}.txt")
        if member is None:
            return b""
        try:
            if self.path.is_dir():
                return (self.path / member).read_bytes()
            with zipfile.ZipFile(self.path) as archive:
                return archive.read(member)
        except ZIP_DAMAGE as error:
            raise self._damaged(error) from None

    def _damaged(self, error: Exception) -> InputError:
        return InputError(str(self.path), f"cannot be read ({error})", "copy the feed anew")


def _members(path: Path) -> dict[str, str]:
    """File of every table by its plain name; the one nearest to the top where there are several."""
    if path.is_dir():
        names = [str(each.relative_to(path)) for each in _files(path)]
    else:
        with zipfile.ZipFile(path) as archive:
            names = archive.namelist()
    found = sorted(
        (name for name in names if not name.startswith("__MACOSX")), key=len, reverse=True
    )
    return {re.split(r"[/\\]", name)[-1].strip().lower(): name for name in found}


def _files(folder: Path) -> Iterator[Path]:
    """Of the folder, and of the folders in it."""
    for each in folder.iterdir():
        if each.is_dir():
            yield from (inner for inner in each.iterdir() if inner.is_file())
        else:
            yield each


def _none_of(table: str) -> pl.DataFrame:
    columns = dict.fromkeys(REQUIRED[table], pl.String)
    return pl.DataFrame(schema={**columns, ROW: pl.UInt32})


def _frame(content: bytes) -> pl.DataFrame:
    """All columns as text; a row that is empty or lacks cells has empty ones."""
    text = _utf_8(content)
    if not text.strip():
        return pl.DataFrame()
    try:
        if any(mark in text for mark in QUOTED_AFTER_BLANK):
            raise pl.exceptions.ComputeError("is read by Python's csv instead")
        frame = pl.read_csv(
            text, infer_schema=False, truncate_ragged_lines=True, encoding="utf8-lossy"
        )
    except pl.exceptions.ComputeError:
        frame = _by_csv(text)
    columns = [pl.col(name).fill_null("") for name in frame.columns]
    if any(blank in text for blank in BLANKS):
        columns = [column.str.strip_chars() for column in columns]
    cells = frame.with_row_index(ROW, offset=2).select(ROW, *columns)
    cells = cells.rename({name: name.strip().lower() for name in _distinct(frame)})
    if b"\n\n" in text or b"\n," in text:
        cells = cells.filter(pl.any_horizontal(pl.exclude(ROW) != ""))
    return cells


def _distinct(frame: pl.DataFrame) -> list[str]:
    """Names of columns that stay different without blanks and capitals: the first of equals."""
    seen: dict[str, str] = {}
    for name in frame.columns:
        seen.setdefault(name.strip().lower(), name)
    return list(seen.values())


def _utf_8(content: bytes) -> bytes:
    """Text with plain line ends in UTF-8 without a byte order mark."""
    try:
        content.decode("utf-8")
    except UnicodeDecodeError:
        content = decoded(content).encode()
    if b"\0" in content:
        content = decoded(content).encode()
    if b"\r" in content:
        content = content.replace(b"\r\n", b"\n").replace(b"\r", b"\n")
    return content.removeprefix(b"\xef\xbb\xbf").lstrip(b"\n")


def _by_csv(text: bytes) -> pl.DataFrame:
    """By Python's own reader, which is slow and takes everything."""
    rows = csv.reader(io.StringIO(text.decode("utf-8", "replace")), skipinitialspace=True)
    header = next(rows, [])
    width = len(header)
    cells = [(row + [""] * width)[:width] for row in rows]
    names = [name if header.index(name) == at else f"{name}~{at}" for at, name in enumerate(header)]
    columns = list(zip(*cells, strict=True)) if cells else [() for _ in header]
    return pl.DataFrame(
        {name: list(column) for name, column in zip(names, columns, strict=True)},
        schema=dict.fromkeys(names, pl.String),
    )
