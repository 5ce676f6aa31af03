"""Makes routes from what others write: so far CSV of points with planned speeds."""

import csv
from collections.abc import Sequence
from pathlib import Path

from wayline.errors import InputError
from wayline.route import Route, make_route

LATITUDE_NAMES = ("lat_deg", "latitude_deg", "latitude", "lat", "y")
LONGITUDE_NAMES = ("lon_deg", "longitude_deg", "longitude", "lon", "lng", "long", "x")
SPEED_FACTORS = {
    "speed_mps": 1.0,
    "speed_m_s": 1.0,
    "speed_ms": 1.0,
    "speed": 1.0,
    "speed_kmh": 1.0 / 3.6,
    "speed_km_h": 1.0 / 3.6,
    "speed_kph": 1.0 / 3.6,
    "speed_mph": 0.44704,
}
"""Column name to what makes metres per second of its values; without a unit they are that."""


def route_from_csv(path: Path, route_id: str, name: str, *, loop: bool) -> Route:
    """A route from a CSV file with a header and columns of latitude, longitude and maybe speed.

    The speed of a point is that of the leg from it to the next (papers/000, data/papers README).
    A loop is closed by repeating its first point, if the file does not; the closing leg then has
    the last point's speed, else the last point's speed is not used. Raises InputError naming the
    line of the file.
    """
    rows = _read_rows(path)
    header = [_plain(cell) for cell in rows[0]] if rows else []
    lat_at = _column(path, header, LATITUDE_NAMES)
    lon_at = _column(path, header, LONGITUDE_NAMES)
    speed_at = _speed_column(path, header)
    points: list[tuple[float, float]] = []
    speeds_mps: list[float] = []
    for number, row in enumerate(rows[1:], start=2):
        if not any(cell.strip() for cell in row):
            continue
        points.append(
            (_number(path, number, row, lat_at, 90.0), _number(path, number, row, lon_at, 180.0))
        )
        if speed_at is not None:
            value = _number(path, number, row, speed_at, float("inf"))
            speeds_mps.append(value * SPEED_FACTORS[header[speed_at]])
    if loop and points:
        points.append(points[0])  # closed already: a leg without length, which is dropped
    return make_route(
        str(path),
        route_id=route_id,
        name=name,
        loop=loop,
        vertices=points,
        speeds_mps=None if speed_at is None else speeds_mps[: len(points) - 1],
        stops=(),
    )


def _read_rows(path: Path) -> list[list[str]]:
    try:
        text = path.read_text(encoding="utf-8-sig")
    except FileNotFoundError:
        raise InputError(str(path), "no such file", "check the path") from None
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(str(path), f"cannot be read ({error})", "check the file") from None
    delimiter = ";" if ";" in text.partition("\n")[0] else ","
    return list(csv.reader(text.splitlines(), delimiter=delimiter))


def _plain(cell: str) -> str:
    """A header cell as it is looked up: `Speed (m/s)` is `speed_m_s`."""
    words = "".join(letter if letter.isalnum() else " " for letter in cell.lower()).split()
    return "_".join(words)


def _column(path: Path, header: Sequence[str], names: Sequence[str]) -> int:
    for name in names:
        if name in header:
            return header.index(name)
    raise InputError(
        str(path), f"no column for {names[2]}", f"name it {' or '.join(names[:3])} in line 1"
    )


def _speed_column(path: Path, header: Sequence[str]) -> int | None:
    """Where the planned speed is, None without one; a unit that is not known is refused."""
    found = next((at for at, cell in enumerate(header) if cell.startswith("speed")), None)
    if found is not None and header[found] not in SPEED_FACTORS:
        raise InputError(
            str(path), f"column {header[found]} has an unknown unit", "name it speed_mps"
        )
    return found


def _number(path: Path, number: int, row: Sequence[str], at: int, limit: float) -> float:
    """A cell as a finite number of at most `limit` either way."""
    text = row[at].strip() if at < len(row) else ""
    try:
        value = float(text)
    except ValueError:
        value = float("nan")
    if not (abs(value) <= limit and abs(value) != float("inf")):
        raise InputError(
            f"{path} line {number}", f"{text!r} is not a number in range", "correct that line"
        )
    return value
