"""A store whose answers everybody who reads the map gets, not only the core that saved."""

from collections.abc import Callable, Sequence

from wayline.core import Record
from wayline_slope_map.profile import RoadProfile
from wayline_slope_map.records import RoadLearned
from wayline_slope_map.store import SlopeStore


class Teaching:
    """Saves to a store and tells what was learned."""

    def __init__(self, store: SlopeStore, learn: Callable[[RoadProfile], None]) -> None:
        self._store, self._learn = store, learn

    def save(self, record: Record) -> Sequence[RoadLearned]:
        """Keep a run durably, then tell of its road."""
        learned = self._store.save(record)
        for each in learned:
            self._learn(each.profile)
        return learned
