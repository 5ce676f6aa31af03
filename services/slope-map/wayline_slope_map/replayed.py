"""Slope-map in a replay."""

from wayline.database import open_database
from wayline.node import Node
from wayline.replayed_drive import ReplayedDrive
from wayline_slope_map.core import SlopeMapCore
from wayline_slope_map.known_roads import KnownRoads
from wayline_slope_map.store import SlopeStore

IN_MEMORY = "sqlite://"


def node(replay: ReplayedDrive) -> Node:
    """Slope-map with the roads that the database knows; the drive's routes, if any, are roads."""
    drive = replay.drive
    store = SlopeStore(open_database(replay.database_url or IN_MEMORY, "wayline_slope_map"))
    roads = KnownRoads(store.load_roads())
    for route in replay.routes:
        roads.follow(route.line, route.route_id, loop=route.loop, bin_m=drive.tuning.map_bin_m)
    route_id = drive.assignment.route_id if drive.assignment else None
    core = SlopeMapCore(roads, drive.tuning, drive.drive.vehicle_id, drive.vehicle, route_id)
    return Node("slope-map", core, store)
