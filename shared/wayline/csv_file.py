"""Reads CSV as programs export it: commas, semicolons, tabs or bars, decimal points or commas."""

import csv
import math
from collections.abc import Iterator, Sequence
from functools import partial
from io import TextIOWrapper
from pathlib import Path
from typing import NamedTuple

from wayline.errors import InputError
from wayline.text_file import LINE_MAX, TextFile

DELIMITERS = ";\t|,"
"""A comma last: where another one separates the columns, commas are in the numbers."""
SEPARATOR_LINE = "sep="
"""Excel's own first line, which names the delimiter."""


class Row(NamedTuple):
    """A row's cells, without blanks around them, and the line of the file where it ends."""

    line: int
    cells: list[str]


class CsvFile:
    """A CSV file, read once. Raises InputError where it cannot be read."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self._file = TextFile(path)

    @property
    def is_broken(self) -> bool:
        """Whether a gzip file could not be unpacked to its end; known when all was read."""
        return self._file.is_broken

    def rows(self) -> Iterator[Row]:
        """The rows that have cells, the header first; lines before it that begin with # are none.

        Raises InputError for what is no CSV.
        """
        try:
            with self._file.text() as text:
                yield from _rows(text)
        except csv.Error as error:
            raise InputError(str(self._path), f"is not CSV ({error})", "check the file") from None


def place_in(header: Sequence[str], name: str, purpose: str, where: str) -> int:
    """Where in a table's rows the column of that name stands. Raises InputError without one."""
    if name.strip() in header:
        return header.index(name.strip())
    mend = f"name one of its columns: {', '.join(header) or 'none, the file is empty'}"
    raise InputError(where, f"no column {name} for {purpose}", mend)


def number_of(text: str) -> float | None:
    """A finite number with a decimal point or a decimal comma, else None."""
    try:
        value = float(text)
    except ValueError:
        if text.count(",") != 1 or "." in text:
            return None
        return number_of(text.replace(",", "."))
    return value if math.isfinite(value) else None


def delimiter_of(header: str) -> str:
    """What separates the columns of a header line: of what it may be that which is there most."""
    return max(DELIMITERS, key=header.count)


def _rows(text: TextIOWrapper) -> Iterator[Row]:
    lines = iter(partial(text.readline, LINE_MAX), "")
    skipped = 0
    header = next(lines, "")
    while header.startswith("#") or not header.strip():
        if not header:
            return
        header, skipped = next(lines, ""), skipped + 1
    delimiter = delimiter_of(header)
    if header.lower().startswith(SEPARATOR_LINE):
        delimiter = header[len(SEPARATOR_LINE) :][:1]
        header, skipped = next(lines, ""), skipped + 1
    if len(delimiter) != 1 or delimiter not in DELIMITERS:
        raise csv.Error(f"columns are separated by {delimiter!r}")
    reader = csv.reader(_with_first(header, lines), delimiter=delimiter)
    for cells in reader:
        if any(cells):
            yield Row(skipped + reader.line_num, [cell.strip() for cell in cells])


def _with_first(first: str, rest: Iterator[str]) -> Iterator[str]:
    yield first
    yield from rest
