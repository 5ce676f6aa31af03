"""Eta in a replay."""

from wayline.database import open_database
from wayline.node import Node
from wayline.replayed_drive import ReplayedDrive
from wayline.timetable.runs import Runs
from wayline_eta.core import assigned_routes, eta_node
from wayline_eta.lessons import Lessons, lessons_by
from wayline_eta.store import EtaStore, EtaTables
from wayline_eta.timetable_core import timetable_node


def node(replay: ReplayedDrive) -> Node:
    """Eta on the drive's routes, or on the trips of its timetables."""
    drive = replay.drive
    lessons = lessons_by(replay.timetables)
    store = _store(replay, lessons)
    if replay.timetables:
        assignment = drive.assignment.name if drive.assignment else None
        return timetable_node(Runs(replay.timetables), drive.tuning, assignment, lessons, store)
    named = drive.assignment.route_id if drive.assignment else None
    return eta_node(assigned_routes(replay.routes, named), drive.tuning, lessons, store)


def _store(replay: ReplayedDrive, lessons: Lessons) -> EtaStore | None:
    """Where a database is named, with what it has kept told."""
    if replay.database_url is None:
        return None
    tables = EtaTables(open_database(replay.database_url, "wayline_eta"), lessons.zone)
    for kept in tables.look():
        lessons.remember(kept)
    return EtaStore(tables, replay.drive.drive.vehicle_id)
