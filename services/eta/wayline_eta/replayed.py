"""Eta in a replay."""

from wayline.node import Node
from wayline.replayed_drive import ReplayedDrive
from wayline.timetable.runs import Runs
from wayline_eta.core import assigned_routes, eta_node
from wayline_eta.timetable_core import timetable_node


def node(replay: ReplayedDrive) -> Node:
    """Eta on the drive's routes, or on the trips of its timetables."""
    drive = replay.drive
    if replay.timetables:
        assignment = drive.assignment.name if drive.assignment else None
        return timetable_node(Runs(replay.timetables), drive.tuning, assignment)
    named = drive.assignment.route_id if drive.assignment else None
    return eta_node(assigned_routes(replay.routes, named), drive.tuning)
