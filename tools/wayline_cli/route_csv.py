"""Reads the lines of a CSV of points: planned ones with speeds, recorded drives, GTFS shapes."""

from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

from wayline.csv_file import CsvFile, Row, number_of
from wayline.errors import InputError
from wayline_cli.imported_line import ImportedLine

LATITUDE_NAMES = ("lat_deg", "latitude_deg", "latitude", "lat", "shape_pt_lat", "y")
LONGITUDE_NAMES = (
    "lon_deg",
    "longitude_deg",
    "longitude",
    "lon",
    "shape_pt_lon",
    "lng",
    "long",
    "x",
)
SPEED_WORDS = {"speed", "velocity"}
SPEED_FACTORS = {
    "": 1.0,
    "mps": 1.0,
    "m_s": 1.0,
    "ms": 1.0,
    "kmh": 1.0 / 3.6,
    "km_h": 1.0 / 3.6,
    "kph": 1.0 / 3.6,
    "mph": 0.44704,
}
"""What stands behind the word in a column's name, to what makes metres per second of its values."""
SLOWEST_MPS = 1.0
"""For a leg that a recorded drive left at speed 0 and reached at 0: it moved, but nobody saw."""


class Columns(NamedTuple):
    """Where the columns are; None where there is none."""

    lat: int
    lon: int
    speed: int | None
    speed_factor: float
    line_id: int | None
    sequence: int | None


class Point(NamedTuple):
    """A row."""

    lat_deg: float
    lon_deg: float
    speed_mps: float


def lines_of_csv(path: Path) -> list[ImportedLine]:
    """The lines of a file with a header and columns of latitude, longitude and maybe speed.

    The speed of a point is that of the leg from it to the next (papers/000, data/papers README).
    Where a recorded drive stood (speed 0), the leg on which it starts has the mean of its ends'.
    Rows of GTFS shapes are put in order and make a line a `shape_id`. Raises InputError naming the
    line of the file.
    """
    file = CsvFile(path)
    rows = list(file.rows())
    if file.is_broken:
        raise InputError(str(path), "is a gzip file that was cut or damaged", "copy it anew")
    columns = _columns(path, [_plain(cell) for cell in rows[0].cells] if rows else [])
    by_line: dict[str, list[tuple[float, Point]]] = {}
    for row in rows[1:]:
        line_id = _cell(row, columns.line_id)
        place = 0.0 if columns.sequence is None else _number(path, row, columns.sequence)
        by_line.setdefault(line_id, []).append((place, _point(path, row, columns)))
    return [
        _line(
            path, line_id, [point for _, point in sorted(points, key=lambda each: each[0])], columns
        )
        for line_id, points in by_line.items()
    ]


def _line(path: Path, line_id: str, points: Sequence[Point], columns: Columns) -> ImportedLine:
    vertices = [(point.lat_deg, point.lon_deg) for point in points]
    if columns.speed is None:
        return ImportedLine(line_id, "", vertices)
    speeds_mps = [point.speed_mps for point in points]
    if not any(speed_mps > 0.0 for speed_mps in speeds_mps):
        what, mend = "no speed is above 0", "correct its column of speeds or take it away"
        raise InputError(str(path), what, mend)
    return ImportedLine(line_id, "", vertices, _moving(speeds_mps))


def _moving(speeds_mps: Sequence[float]) -> list[float]:
    """Speeds of the legs after points, none of them 0."""
    ends = [*speeds_mps[1:], 0.0]
    return [
        speed_mps if speed_mps > 0.0 else max(end_mps / 2.0, SLOWEST_MPS)
        for speed_mps, end_mps in zip(speeds_mps, ends, strict=True)
    ]


def _point(path: Path, row: Row, columns: Columns) -> Point:
    lat_deg = _number(path, row, columns.lat, 90.0)
    lon_deg = _number(path, row, columns.lon, 180.0)
    if columns.speed is None:
        return Point(lat_deg, lon_deg, 0.0)
    speed_mps = _number(path, row, columns.speed) * columns.speed_factor
    if speed_mps < 0.0:
        raise InputError(f"{path} line {row.line}", "the speed is below 0", "correct that line")
    return Point(lat_deg, lon_deg, speed_mps)


def _plain(cell: str) -> str:
    """A header cell as it is looked up: `Speed (m/s)` is `speed_m_s`."""
    words = "".join(letter if letter.isalnum() else " " for letter in cell.lower()).split()
    return "_".join(words)


def _columns(path: Path, header: Sequence[str]) -> Columns:
    speed, factor = _speed_column(path, header)
    line_id = header.index("shape_id") if "shape_id" in header else None
    sequence = header.index("shape_pt_sequence") if "shape_pt_sequence" in header else None
    lat, lon = _column(path, header, LATITUDE_NAMES), _column(path, header, LONGITUDE_NAMES)
    return Columns(lat, lon, speed, factor, line_id, sequence)


def _column(path: Path, header: Sequence[str], names: Sequence[str]) -> int:
    """The column of a name, else the only one with a name among its words (`GPS Latitude`)."""
    for name in names:
        if name in header:
            return header.index(name)
    words = {name for name in names if len(name) > 1}
    found = [at for at, cell in enumerate(header) if not words.isdisjoint(cell.split("_"))]
    if len(found) == 1:
        return found[0]
    raise InputError(
        str(path), f"no column for {names[2]}", f"name it {' or '.join(names[:3])} in line 1"
    )


def _speed_column(path: Path, header: Sequence[str]) -> tuple[int | None, float]:
    """Where the planned speed is and its factor; a unit that is not known is refused."""
    units = {
        at: "_".join(cell.split("_")[word + 1 :])
        for at, cell in enumerate(header)
        for word, text in enumerate(cell.split("_"))
        if text in SPEED_WORDS
    }
    for at, unit in units.items():
        if unit in SPEED_FACTORS:
            return at, SPEED_FACTORS[unit]
    if units:
        what = f"column {header[next(iter(units))]} has an unknown unit"
        raise InputError(str(path), what, "name it speed_mps")
    return None, 1.0


def _cell(row: Row, at: int | None) -> str:
    return row.cells[at] if at is not None and at < len(row.cells) else ""


def _number(path: Path, row: Row, at: int, limit: float = float("inf")) -> float:
    """A cell as a finite number of at most `limit` either way."""
    text = _cell(row, at)
    value = number_of(text)
    if value is None or abs(value) > limit:
        is_place = value is not None and limit < float("inf")
        mend = "correct that line" + (", or exchange latitude and longitude" if is_place else "")
        raise InputError(f"{path} line {row.line}", f"{text!r} is not a number in range", mend)
    return value
