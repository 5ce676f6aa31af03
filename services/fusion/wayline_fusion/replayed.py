"""Fusion in a replay."""

from wayline.database import open_database
from wayline.node import Node
from wayline.replayed_drive import ReplayedDrive
from wayline_fusion.core import FusionCore
from wayline_fusion.keeping.store import FusionStore


def node(replay: ReplayedDrive) -> Node:
    """Fusion, going on from what the database knows of the drive's vehicle."""
    vehicle = replay.drive.vehicle
    tuning, url = replay.drive.tuning, replay.database_url
    if url is None:
        return Node("fusion", FusionCore(tuning, vehicle=vehicle))
    store = FusionStore(open_database(url, "wayline_fusion"), replay.drive.drive.vehicle_id)
    return Node("fusion", FusionCore(tuning, store.load(), vehicle), store)
