"""Makes a route from one trip of a GTFS feed: its shape, its stops and its timetable."""

import csv
import io
import re
import struct
import zipfile
import zlib
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from wayline.errors import InputError
from wayline.line import Line
from wayline.log_file import decoded
from wayline.route import DEFAULT_SPEED_MPS, Route, make_route
from wayline.stops import StopPlace, place_stops

Floats = NDArray[np.float64]
Row = dict[str, str]

SLOWEST_MPS, FASTEST_MPS = 1.0, 40.0
"""Timetables are written in whole minutes: what they imply is kept within this."""
ZIP_DAMAGE = (
    OSError, EOFError, ValueError, RuntimeError, struct.error, zlib.error, zipfile.BadZipFile,
)  # fmt: skip
"""What zipfile raises for files that are damaged, encrypted or newer than it."""
REQUIRED = {
    "trips": ("trip_id", "route_id"),
    "stops": ("stop_id", "stop_lat", "stop_lon"),
    "stop_times": ("trip_id", "stop_id", "stop_sequence"),
    "shapes": ("shape_id", "shape_pt_lat", "shape_pt_lon", "shape_pt_sequence"),
}
"""Columns without which a table is of no use."""
TIME_PATTERN = re.compile(r"(\d{1,3}):(\d\d):(\d\d)")


class Feed:
    """The tables of a GTFS feed, a folder or a zip file of CSV files."""

    def __init__(self, path: Path) -> None:
        self.path = path
        if not path.exists():
            raise InputError(str(path), "no such file", "name a GTFS folder or zip file")
        if not path.is_dir() and not zipfile.is_zipfile(path):
            raise InputError(str(path), "is not a GTFS feed", "name a GTFS folder or zip file")

    def rows(self, table: str, **wanted: str) -> Iterator[Row]:
        """The rows of a table whose columns have the wanted values; none of a missing table."""
        where, text = f"{self.path} {table}.txt", io.StringIO(self._text(f"{table}.txt"))
        try:
            header = [name.strip() for name in next(csv.reader(text, skipinitialspace=True), [])]
            missing = [column for column in REQUIRED[table] if column not in header]
            if header and missing:
                raise InputError(where, f"has no column {missing[0]}", "correct the feed")
            for row in csv.DictReader(text, header, restval="", skipinitialspace=True):
                if all(row.get(column) == value for column, value in wanted.items()):
                    yield row
        except csv.Error as error:
            raise InputError(where, f"is not CSV ({error})", "correct the feed") from None

    def row(self, table: str, **wanted: str) -> Row:
        """The one row with the wanted values, or InputError."""
        for row in self.rows(table, **wanted):
            return row
        what = " ".join(f"{column} {value}" for column, value in wanted.items())
        raise InputError(f"{self.path} {table}.txt", f"no {what}", "name one that it has")

    def sorted_rows(self, table: str, column: str, **wanted: str) -> list[Row]:
        """The rows with the wanted values in the order of a column of whole numbers."""
        try:
            return sorted(self.rows(table, **wanted), key=lambda row: int(row[column]))
        except (KeyError, ValueError):
            raise InputError(
                f"{self.path} {table}.txt", f"{column} is not a whole number", "correct the feed"
            ) from None

    def _text(self, name: str) -> str:
        try:
            if self.path.is_dir():
                file = self.path / name
                return decoded(file.read_bytes()) if file.exists() else ""
            with zipfile.ZipFile(self.path) as archive:
                return decoded(archive.read(member)) if (member := _member(archive, name)) else ""
        except ZIP_DAMAGE as error:
            raise InputError(
                f"{self.path} {name}", f"cannot be read ({error})", "check the feed"
            ) from None


def _member(archive: zipfile.ZipFile, name: str) -> str | None:
    """A table's place in a zip file: at the top, or in the folder that was packed."""
    found = [each for each in archive.namelist() if each.rpartition("/")[2] == name]
    return min(found, key=len, default=None)


def only_trip(path: Path) -> str:
    """The trip of a feed that has one. Raises InputError where it has none, or several."""
    trips = [row.get("trip_id", "") for row in Feed(path).rows("trips")]
    if len(trips) == 1:
        return trips[0]
    if not trips:
        raise InputError(f"{path} trips.txt", "holds no trip", "name a GTFS folder or zip file")
    shown = ", ".join(trips[:3])
    mend = f"name one of its trips.txt with --trip, e.g. {shown}"
    raise InputError(str(path), f"is a GTFS feed of {len(trips):,} trips", mend)


def route_from_gtfs(path: Path, trip_id: str) -> Route:
    """The route that a trip drives, its planned speeds from the trip's timetable.

    A vertex is put at each stop, so that the planned time between two stops is the timetable's;
    `dwell_s` is departure minus arrival. The route's id is the feed's with the trip's direction,
    where it has one (`5A-1`). A trip without a shape goes straight from stop to stop.
    """
    feed = Feed(path)
    trip = feed.row("trips", trip_id=trip_id)
    times = feed.sorted_rows("stop_times", "stop_sequence", trip_id=trip_id)
    stops = _stops(feed, times)
    vertices = _vertices(feed, trip, stops)
    where = f"{path} trip {trip_id}"
    line = _checked_line(where, vertices)
    placed = place_stops(where, line, stops, loop=False)
    alongs_m = np.array([stop.distance_m for stop in placed])
    line = _with_vertices_at(line, alongs_m)
    arrivals_s = np.array([_seconds(where, row.get("arrival_time", "")) for row in times])
    departures_s = np.array([_seconds(where, row.get("departure_time", "")) for row in times])
    return make_route(
        where,
        route_id="-".join(filter(None, (trip["route_id"], trip.get("direction_id")))),
        name=trip.get("trip_headsign") or trip["route_id"],
        loop=False,
        vertices=list(zip(line.lats_deg.tolist(), line.lons_deg.tolist(), strict=True)),
        speeds_mps=_leg_speeds(line, alongs_m, arrivals_s, departures_s).tolist(),
        stops=[
            stop._replace(dwell_s=float(dwell_s))
            for stop, dwell_s in zip(
                stops, np.nan_to_num(departures_s - arrivals_s).clip(0.0), strict=True
            )
        ],
    )


def _stops(feed: Feed, times: Sequence[Row]) -> list[StopPlace]:
    known = {row["stop_id"]: row for row in feed.rows("stops")}
    stops = []
    for row in times:
        if row["stop_id"] not in known:
            raise InputError(
                f"{feed.path} stops.txt", f"no stop_id {row['stop_id']}", "complete the feed"
            )
        stop = known[row["stop_id"]]
        place = _position(feed, stop, "stop_lat", "stop_lon")
        stops.append(StopPlace(row["stop_id"], stop.get("stop_name") or row["stop_id"], *place))
    return stops


def _vertices(feed: Feed, trip: Row, stops: Sequence[StopPlace]) -> list[tuple[float, float]]:
    shape_id = trip.get("shape_id")
    if not shape_id:
        return [(stop.lat_deg, stop.lon_deg) for stop in stops]
    points = feed.sorted_rows("shapes", "shape_pt_sequence", shape_id=shape_id)
    return [_position(feed, row, "shape_pt_lat", "shape_pt_lon") for row in points]


def _position(feed: Feed, row: Row, lat: str, lon: str) -> tuple[float, float]:
    try:
        return float(row[lat]), float(row[lon])
    except (KeyError, ValueError):
        raise InputError(
            str(feed.path), f"a row has no number in {lat} and {lon}", "correct the feed"
        ) from None


def _checked_line(where: str, vertices: Sequence[tuple[float, float]]) -> Line:
    return make_route(
        where, route_id="", name="", loop=False, vertices=vertices, speeds_mps=None, stops=()
    ).line


def _with_vertices_at(line: Line, alongs_m: Floats) -> Line:
    """A line with vertices added at distances along it."""
    distances_m = np.unique(np.round(np.concatenate((line.distances_m, alongs_m)), 2))
    points = np.array([line.point_at(float(distance_m))[:2] for distance_m in distances_m])
    return Line(points[:, 0], points[:, 1])


def _seconds(where: str, text: str) -> float:
    """Seconds of a GTFS time, which may go past 24 hours; NaN where none is given."""
    if not text.strip():
        return float("nan")
    if not (parts := TIME_PATTERN.fullmatch(text.strip())):
        raise InputError(where, f"time {text!r} is not HH:MM:SS", "correct stop_times.txt")
    hours, minutes, seconds = (int(part) for part in parts.groups())
    return 3600.0 * hours + 60.0 * minutes + seconds


def _leg_speeds(line: Line, alongs_m: Floats, arrivals_s: Floats, departures_s: Floats) -> Floats:
    """Per leg the speed between the timed stops around it; beyond them that of the nearest."""
    sections = _sections(alongs_m, arrivals_s, departures_s)
    if not sections:
        return np.full(len(line.legs_m), DEFAULT_SPEED_MPS)
    ends_m = np.array([end_m for end_m, _ in sections])
    speeds_mps = np.array([speed_mps for _, speed_mps in sections])
    middles_m = line.distances_m[:-1] + line.legs_m / 2.0
    section = np.minimum(np.searchsorted(ends_m, middles_m), len(ends_m) - 1)
    return np.asarray(speeds_mps[section])


def _sections(
    alongs_m: Floats, arrivals_s: Floats, departures_s: Floats
) -> list[tuple[float, float]]:
    """End and speed of every stretch between two stops that the timetable tells apart."""
    sections: list[tuple[float, float]] = []
    last: int | None = None
    for stop in np.flatnonzero(np.isfinite(arrivals_s) & np.isfinite(departures_s)):
        if last is not None:
            moved_m = alongs_m[stop] - alongs_m[last]
            took_s = arrivals_s[stop] - departures_s[last]
            if moved_m <= 0.0 or took_s <= 0.0:
                continue
            speed_mps = float(np.clip(moved_m / took_s, SLOWEST_MPS, FASTEST_MPS))
            sections.append((float(alongs_m[stop]), speed_mps))
        last = int(stop)
    return sections
