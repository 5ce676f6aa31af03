"""Reads a road's grade by place: what `wayline slope export` writes, or any table like it."""

import csv
from pathlib import Path
from typing import NamedTuple

import numpy as np

from wayline.errors import InputError
from wayline_evaluation.estimates import Floats
from wayline_evaluation.slope_places import Places, nearest_to

NEEDED = ("lat_deg", "lon_deg", "grade_pct")
HEADING = "heading_deg"


class RoadReference(NamedTuple):
    """Grades in the direction of the headings, where those are known, shape (n,)."""

    places: Places
    grades_pct: Floats

    def at(self, points: Places) -> Floats:
        """The grade at points of a road; nan where none is known near by on the same way."""
        rows, is_near = nearest_to(points, self.places)
        return np.where(is_near, self.grades_pct[np.where(is_near, rows, 0)], np.nan)


def read_road(path: Path) -> RoadReference:
    """A table of places with their grades; columns besides are left alone. Raises InputError."""
    try:
        with path.open(encoding="utf-8-sig", newline="") as file:
            rows = list(csv.DictReader(file))
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise InputError(str(path), f"cannot be read ({error})", "check the file") from None
    mend = f"give a CSV with the columns {', '.join(NEEDED)} and, where known, {HEADING}"
    if not rows:
        raise InputError(str(path), "has no rows", mend)
    if missing := [name for name in NEEDED if name not in rows[0]]:
        raise InputError(str(path), f"no column {missing[0]}", mend)
    try:
        lats_deg, lons_deg, grades_pct = (_column(rows, name) for name in NEEDED)
        headings_deg = _column(rows, HEADING) if HEADING in rows[0] else np.full(len(rows), np.nan)
    except ValueError as error:
        raise InputError(str(path), str(error), "write numbers in every row") from None
    return RoadReference(Places(lats_deg, lons_deg, headings_deg), grades_pct)


def _column(rows: list[dict[str, str]], name: str) -> Floats:
    return np.array([row[name] for row in rows], dtype=np.float64)
