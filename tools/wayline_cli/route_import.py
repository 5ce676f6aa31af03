"""Makes a route of what others write: GTFS, GPX, any GeoJSON line, CSV of points."""

import zipfile
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

from wayline.errors import InputError
from wayline.log_file import decoded, head_of
from wayline.route import Route, make_route
from wayline.timetable.notes import Notes
from wayline.timetable.reading import read_timetable
from wayline.timetable.tables import ZIP_DAMAGE
from wayline_cli.gtfs_route import only_trip, route_of_trip, routes_of_patterns
from wayline_cli.imported_line import ImportedLine, only_line
from wayline_cli.route_csv import lines_of_csv
from wayline_cli.route_geojson import lines_of_geojson
from wayline_cli.route_gpx import lines_of_gpx

READABLE = "give CSV, GPX, GeoJSON or a GTFS feed"
KNOWN_OTHERS = {
    "<kml": "is KML",
    "%PDF": "is a PDF",
    "xl/workbook.xml": "is an Excel workbook",
    "doc.kml": "is KMZ",
    "content.xml": "is an office document",
}
"""What a file begins with, or a zip file holds, and what it is then."""


class Wishes(NamedTuple):
    """What the user says of the route; None: as the file says."""

    route_id: str | None = None
    name: str | None = None
    loop: bool | None = None
    line: str | None = None
    """Of a file with several lines: id, name or number."""
    trip: str | None = None
    """Of a GTFS feed."""


def import_route(source: Path, wishes: Wishes, notes: Notes | None = None) -> Route:
    """The route of a file, of whatever kind its content is; `notes` gets what was mended.

    Raises InputError.
    """
    if is_feed(source):
        notes = notes or Notes()
        timetable = read_timetable(source, notes)
        return route_of_trip(timetable, wishes.trip or only_trip(timetable), notes)
    line = only_line(source, _lines(source), wishes.line)
    route_id = wishes.route_id or line.line_id or source.name.partition(".")[0]
    return route_from_line(source, line, route_id, wishes)


def import_patterns(source: Path, notes: Notes) -> list[Route]:
    """A route for every pattern of a GTFS feed; `notes` gets what was mended. Raises InputError."""
    return list(routes_of_patterns(read_timetable(source, notes), notes))


def is_feed(source: Path) -> bool:
    """Whether it is a folder or a zip file. Raises InputError for one that holds something else."""
    if not source.exists():
        raise InputError(str(source), "no such file", "check the path")
    if not source.is_dir() and not zipfile.is_zipfile(source):
        return False
    _check_zip(source)
    return True


def route_from_line(source: Path, line: ImportedLine, route_id: str, wishes: Wishes) -> Route:
    """A line as a route. A loop is closed by repeating its first point, if the file does not.

    The closing leg has the last point's speed where there is one. Raises InputError.
    """
    loop = line.loop if wishes.loop is None else wishes.loop
    vertices = list(line.vertices)
    if loop and vertices:
        vertices.append(vertices[0])  # closed already: a leg without length, which is dropped
    return make_route(
        str(source),
        route_id=route_id,
        name=wishes.name or line.name or route_id,
        loop=loop,
        vertices=vertices,
        speeds_mps=_leg_speeds(line.speeds_mps, len(vertices) - 1),
        stops=line.stops,
    )


def _leg_speeds(speeds_mps: Sequence[float] | None, legs: int) -> list[float] | None:
    """One speed a leg: a last point's is left over, and a closing leg goes on at the one before."""
    if not speeds_mps:
        return None
    speeds = list(speeds_mps)
    if len(speeds) == legs - 1:
        speeds.append(speeds[-1])
    return speeds[:legs] if len(speeds) == legs + 1 else speeds


def _lines(source: Path) -> list[ImportedLine]:
    begins = decoded(head_of(source)).lstrip()
    if begins.startswith(("{", "[")):
        return lines_of_geojson(source)
    _check_other(source, begins)
    return lines_of_gpx(source) if begins.startswith("<") else lines_of_csv(source)


def _check_other(source: Path, begins: str) -> None:
    for mark, what in KNOWN_OTHERS.items():
        if mark in begins:
            raise InputError(str(source), what, READABLE)


def _check_zip(source: Path) -> None:
    if source.is_dir():
        return
    try:
        with zipfile.ZipFile(source) as archive:
            names = archive.namelist()
    except ZIP_DAMAGE as error:
        raise InputError(str(source), f"is a broken zip file ({error})", "copy it anew") from None
    _check_other(source, "\n".join(names))
