"""Reads the line of a road from a file: a route or other GeoJSON, GPX, or an earlier drive."""

import csv
from pathlib import Path

import msgspec
import numpy as np

from wayline.drive_file import load_drive
from wayline.errors import InputError
from wayline.geojson import Feature, read_features
from wayline.gpx import read_gpx
from wayline.route import Route
from wayline.route_file import load_route
from wayline_simulator.course import Floats
from wayline_simulator.line_course import LineFile, LinePoints

MEND = "name a GeoJSON route, a GPX track or the folder of a drive with truth or route"


def read_line(path: Path) -> LineFile:
    """The road that a file describes. Raises InputError."""
    if path.is_dir():
        return _read_drive(path)
    if path.suffix.lower() == ".gpx":
        return _read_gpx(path)
    if path.suffix.lower() == ".csv":
        return _read_truth(path)
    return _read_geojson(path)


def _read_drive(folder: Path) -> LineFile:
    drive = load_drive(folder)
    if drive.truth is not None:
        return _read_truth(Path(drive.truth.path))
    if drive.route is not None:
        if len(drive.route.paths) > 1:
            what = f"a drive with {len(drive.route.paths)} routes"
            raise InputError(str(folder), what, "name the file of one")
        return _read_geojson(Path(drive.route.paths[0]))
    raise InputError(str(folder), "a drive without truth and without route", MEND)


def _read_geojson(path: Path) -> LineFile:
    """A LineString; a route if it says so with a `route_id`."""
    lines = [feature for feature in read_features(path) if feature.kind == "LineString"]
    if len(lines) != 1:
        raise InputError(str(path), f"{len(lines)} LineString features", "keep exactly one")
    alts_m = _third_coordinates(lines[0])
    if "route_id" in (lines[0].properties or {}):
        return _from_route(path, load_route(path), alts_m)
    places = lines[0].positions(str(path), "the line")
    return LineFile(_points(path, places, alts_m), (), loop=False)


def _from_route(path: Path, route: Route, alts_m: list[float] | None) -> LineFile:
    line = route.line
    # a route drops legs without length, and with them their altitudes' places
    fits = alts_m is not None and len(alts_m) == len(line.lats_deg)
    places = list(zip(line.lats_deg.tolist(), line.lons_deg.tolist(), strict=True))
    points = _points(path, places, alts_m if fits else None)
    return LineFile(points._replace(speeds_mps=route.speeds_mps), route.stops, route.loop)


def _third_coordinates(feature: Feature) -> list[float] | None:
    """Altitudes of a line all of whose positions have one."""
    rows = feature.geometry.coordinates if feature.geometry else []
    try:
        return [row[2] for row in msgspec.convert(rows, list[list[float]])]
    except (msgspec.ValidationError, IndexError):
        return None


def _read_gpx(path: Path) -> LineFile:
    """The points of all tracks and routes of a GPX file, in their order."""
    points = [point for line in read_gpx(path) for point in line.points]
    alts_m = [point.alt_m for point in points if point.alt_m is not None]
    places = [(point.lat_deg, point.lon_deg) for point in points]
    return LineFile(_points(path, places, alts_m), (), loop=False)


def _read_truth(path: Path) -> LineFile:
    """The way of an earlier drive, standstills left out."""
    try:
        with path.open(newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        places = [(float(row["lat_deg"]), float(row["lon_deg"])) for row in rows]
        alts_m = [float(row["alt_m"]) for row in rows if row.get("alt_m")]
    except FileNotFoundError:
        raise InputError(str(path), "no such file", "check the path") from None
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(str(path), f"cannot be read ({error})", "check the file") from None
    except (KeyError, ValueError, TypeError) as error:
        what = f"has no numbers in lat_deg and lon_deg ({error})"
        raise InputError(str(path), what, MEND) from None
    return LineFile(_points(path, places, alts_m), (), loop=False)


def _points(
    path: Path, places: list[tuple[float, float]], alts_m: list[float] | None
) -> LinePoints:
    """Points that differ from the one before them; altitudes only where every point has one."""
    table = np.array(places, dtype=np.float64).reshape(-1, 2)
    known = alts_m is not None and len(alts_m) == len(table)
    heights: Floats | None = np.array(alts_m, dtype=np.float64) if known else None
    if len(table) < 2 or not np.isfinite(table).all() or np.abs(table).max() > 180.0:
        raise InputError(str(path), f"{len(table)} points, not a line on Earth", MEND)
    kept = np.concatenate(([True], np.any(np.diff(table, axis=0) != 0.0, axis=1)))
    lats_deg, lons_deg = table[kept].T
    return LinePoints(lats_deg, lons_deg, None if heights is None else heights[kept], None)
