"""What a core hands its runs to: they are smoothed and kept later, perhaps much later."""

from collections.abc import Sequence

from wayline.core import Record, Store
from wayline_slope_map.known_roads import KnownRoads
from wayline_slope_map.profile import RoadProfile
from wayline_slope_map.records import DrivenRun, RoadLearned


class Teaching:
    """Lets the cores know the line of a new road before the run that made it is kept.

    Else, until it is, each lap would make a road of its own.
    """

    def __init__(self, store: Store, roads: KnownRoads) -> None:
        self._store, self._roads = store, roads

    def save(self, record: Record) -> Sequence[RoadLearned]:
        """Have a run kept; the answers are its roads without slopes, where those are new."""
        self._store.save(record)
        if not isinstance(record, DrivenRun):
            return ()
        known = self._roads.roads()
        new = {stretch.road.road_id: stretch.road for stretch in record.stretches}
        return [
            RoadLearned(RoadProfile(road, {})) for road in new.values() if road.road_id not in known
        ]
