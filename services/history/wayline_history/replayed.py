"""History in a replay."""

import time
from collections.abc import Sequence

import msgspec

from wayline.core import Record
from wayline.database import open_database
from wayline.node import Node
from wayline.replayed_drive import ReplayedDrive
from wayline_history.core import HistoryCore
from wayline_history.records import Piece
from wayline_history.store import HistoryStore

PIECE_NS = 600_000_000_000
"""Nothing is lost of a replay that is not wanted again, so it writes seldom."""


class ReplayStore:
    """Keeps the pieces of one drive."""

    def __init__(self, store: HistoryStore, vehicle_id: str) -> None:
        self._store, self._vehicle_id = store, vehicle_id

    def save(self, record: Record) -> Sequence[msgspec.Struct]:
        """Keep a piece durably before returning."""
        if not isinstance(record, Piece):
            raise TypeError(f"the history keeps no {type(record).__name__}")
        self._store.save([(self._vehicle_id, record)])
        return ()


def node(replay: ReplayedDrive) -> Node:
    """History of the drive; it is kept where a database is named."""
    vehicle_id = replay.drive.drive.vehicle_id
    core = HistoryCore(vehicle_id, piece_ns=PIECE_NS)
    if replay.database_url is None:
        return Node("history", core)
    store = HistoryStore(open_database(replay.database_url, "wayline_history"), time.time)
    return Node("history", core, ReplayStore(store, vehicle_id))
