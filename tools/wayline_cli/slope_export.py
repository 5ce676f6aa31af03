"""Writes a slope database as CSV (SPEC section 4)."""

import csv
from contextlib import nullcontext
from pathlib import Path
from typing import TextIO

from wayline.database import open_database
from wayline.errors import InputError
from wayline_slope_map.export import ExportRow, export_rows


def export_slope_csv(database_url: str, out: Path | None, stdout: TextIO) -> int:
    """Write one row a bin to `out`, or to `stdout` without it; returns the number of rows.

    Raises InputError for a database that is not there or an output that cannot be written.
    """
    engine = open_database(database_url, "wayline_slope_map", create=False)
    try:
        with nullcontext(stdout) if out is None else _opened(out) as stream:
            writer = csv.writer(stream, lineterminator="\n")
            writer.writerow(ExportRow._fields)
            count = 0
            for row in export_rows(engine):
                writer.writerow(row)
                count += 1
    finally:
        engine.dispose()
    return count


def _opened(out: Path) -> TextIO:
    try:
        return out.open("w", encoding="utf-8", newline="")
    except OSError as error:
        what = f"cannot be written ({error.strerror})"
        raise InputError(str(out), what, "name a file in a folder that exists") from None
