"""What a core hands its runs to: a store that keeps them later, perhaps much later."""

from collections.abc import Sequence

from wayline.core import Record, Store
from wayline_slope_map.known_roads import KnownRoads
from wayline_slope_map.profile import RoadProfile
from wayline_slope_map.records import FinishedRun, RoadLearned


class Teaching:
    """Lets the cores know the line of a new road before the run that made it is kept.

    Else, while the database is away, each lap would make a road of its own.
    """

    def __init__(self, store: Store, roads: KnownRoads) -> None:
        self._store, self._roads = store, roads

    def save(self, record: Record) -> Sequence[RoadLearned]:
        """Have a run kept; the answer is its road without slopes, where that is new."""
        self._store.save(record)
        if not isinstance(record, FinishedRun) or record.road.road_id in self._roads.roads():
            return ()
        return [RoadLearned(RoadProfile(record.road, {}))]
