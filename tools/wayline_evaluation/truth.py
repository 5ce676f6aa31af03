"""Reads a drive's truth.csv (SPEC section 3)."""

import io
import re
from pathlib import Path

import numpy as np

from wayline.errors import InputError
from wayline_evaluation.reference import Reference, true_reference

NEEDED = ("t_s", "lat_deg", "lon_deg")
OPTIONAL = ("alt_m", "heading_deg", "speed_mps", "grade_pct")
EMPTY_CELL = re.compile(r"(?<=,)(?=,|$)", re.MULTILINE)


def read_truth(path: Path) -> Reference:
    """The truth; columns besides time and place may be missing, others may be there.

    Raises InputError.
    """
    try:
        header, _, body = path.read_text(encoding="utf-8").partition("\n")
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(str(path), f"cannot be read ({error})", "check the file") from None
    names = [name.strip() for name in header.split(",")]
    if missing := [name for name in NEEDED if name not in names]:
        mend = f"give the columns {', '.join(NEEDED)}"
        raise InputError(str(path), f"no column {missing[0]}", mend)
    read = [name for name in names if name in {*NEEDED, *OPTIONAL}]
    places = [names.index(name) for name in read]
    try:
        lines = io.StringIO(EMPTY_CELL.sub("nan", body))
        table = np.loadtxt(lines, delimiter=",", ndmin=2, dtype=np.float64, usecols=places)
    except ValueError as error:
        raise InputError(str(path), str(error), "write numbers in every row") from None
    if len(table) < 2:
        raise InputError(str(path), "has too few rows", "write it again")
    columns = dict(zip(read, table.T, strict=True))
    if not np.all(np.diff(columns["t_s"]) > 0.0):
        raise InputError(str(path), "t_s does not increase", "sort its rows")
    place = (columns[name] for name in NEEDED)
    alt_m, heading_deg, speed_mps, grade_pct = (columns.get(name) for name in OPTIONAL)
    return true_reference(
        *place,
        alts_m=alt_m,
        headings_deg=heading_deg,
        speeds_mps=speed_mps,
        grades_pct=grade_pct,
    )
