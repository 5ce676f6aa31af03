"""`wayline evaluate distance`: how far drives went, and by GPS alone beside truth or wheels."""

from collections.abc import Sequence
from pathlib import Path

from wayline.drive import Drive
from wayline.errors import InputError
from wayline.line import Line
from wayline.route_file import load_route
from wayline.trip_distance.speeds import unit_doubt
from wayline.trip_distance.track import track_of
from wayline_evaluation.distances import (
    DistanceReport,
    DriveDistance,
    distance_report,
    judged,
    measured_trip,
)
from wayline_evaluation.replays import Progressed, done_by, drive_name
from wayline_evaluation.smoothing.reading import Read, read_drive, reference_of
from wayline_evaluation.smoothing.trip import Reference


def distance_study(folders: Sequence[Path], jobs: int, progressed: Progressed) -> DistanceReport:
    """Every drive as one trip. Raises InputError where nothing tells how far one went."""
    return distance_report(list(done_by(drive_distance, list(folders), jobs, progressed)))


def drive_distance(folder: Path) -> DriveDistance:
    """One drive; its route bridges holes where it has one."""
    read = read_drive(folder)
    tuning, route = read.drive.tuning, _route(read.drive)
    measured, doubts = measured_trip(read.fixes, read.wheels, tuning, route)
    if measured is None:
        mend = "name a drive with two fixes or more, or with wheels"
        raise InputError(str(folder), "nothing in it tells how far it went", mend)
    by_gps, _ = measured_trip(read.fixes, (), tuning, route)
    reference = None if by_gps is None else _reference(read)
    return judged(drive_name(folder), measured, by_gps, reference, (*read.notes, *doubts))


def _reference(read: Read) -> Reference | None:
    track = track_of(read.fixes, read.drive.tuning)
    found = reference_of(read.drive, read.fixes, track, read.wheels)
    return None if found.kind != "truth" and unit_doubt(track) else found


def _route(drive: Drive) -> Line | None:
    """The one that a drive follows; of several it is not known which."""
    if drive.route is None or len(drive.route.paths) != 1:
        return None
    return load_route(Path(drive.route.paths[0])).line
