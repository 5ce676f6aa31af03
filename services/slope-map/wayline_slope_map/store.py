"""Keeps the slope map in its database: merges each run once, into sums that do not grow."""

from collections.abc import Mapping, Sequence

import sqlalchemy as sa

from wayline.core import Record
from wayline.database import write_transaction
from wayline_slope_map.drives import Kept, kept_of
from wayline_slope_map.known_slopes import estimates, roads
from wayline_slope_map.left_out import COUNTED, LeftOut
from wayline_slope_map.left_out_rows import keep
from wayline_slope_map.merging import merge
from wayline_slope_map.profile import RoadProfile
from wayline_slope_map.records import DrivenRun, FinishedRun, RoadLearned
from wayline_slope_map.run import outcome
from wayline_slope_map.tables import LEDGER, ROADS
from wayline_slope_map.tally import Tally


class SlopeStore:
    """The slope database on an engine from `open_database(url, "wayline_slope_map")`."""

    def __init__(self, engine: sa.Engine, tally: Tally | None = None) -> None:
        self._engine, self._tally = engine, tally or Tally()

    @property
    def left_out(self) -> Mapping[str, int]:
        """How many parts of drives have taught nothing, by reason."""
        return self._tally.counts

    def save(self, record: Record) -> Sequence[RoadLearned]:
        """Merge a finished run, or what a driven one comes to; answers with the roads as now known.

        A run that the ledger holds already, or one that overlaps in time with a run of the same
        vehicle, road and direction, changes nothing and has no answer. What is left out of the map
        is kept beside it and has none either.
        """
        match record:
            case DrivenRun():
                return [learned for each in outcome(record) for learned in self.save(each)]
            case FinishedRun():
                return self._merge(record)
            case LeftOut():
                with write_transaction(self._engine) as connection:
                    keep(connection, record)
                self._tally.count(record.reason)
                return []
        raise TypeError(f"the slope map keeps no {type(record).__name__}")

    def _merge(self, record: FinishedRun) -> Sequence[RoadLearned]:
        with write_transaction(self._engine) as connection:
            if connection.dialect.name == "postgresql":
                # two processes must not both find the ledger empty
                connection.execute(sa.text("LOCK TABLE slope_ledger IN EXCLUSIVE MODE"))
            if not merge(connection, record):
                self._tally.count(COUNTED)
                return []
            found = estimates(connection, record.road.road_id)[record.road.road_id]
        return [RoadLearned(RoadProfile(record.road, found))]

    def load_roads(self) -> list[RoadProfile]:
        """Every road with its fused bins, in order of id."""
        with self._engine.connect() as connection:
            found = estimates(connection)
            return [RoadProfile(road, found[road.road_id]) for road in roads(connection)]

    def load_road(self, road_id: str) -> RoadProfile:
        """One road that is there, with its fused bins."""
        with self._engine.connect() as connection:
            (road,) = roads(connection, road_id)
            return RoadProfile(road, estimates(connection, road_id)[road_id])

    def run_counts(self) -> dict[str, int]:
        """How many runs each road has: that of a road which was written to is another."""
        here = sa.and_(ROADS.c.road_id == LEDGER.c.road_id, sa.not_(LEDGER.c.withdrawn))
        query = (
            sa.select(ROADS.c.road_id, sa.func.count(LEDGER.c.road_id))
            .outerjoin_from(ROADS, LEDGER, here)
            .group_by(ROADS.c.road_id)
        )
        with self._engine.connect() as connection:
            return {row[0]: row[1] for row in connection.execute(query)}


class SlopeTables:
    """The slope database for a `PatientStore`: tells of every road, then of those that changed."""

    def __init__(self, engine: sa.Engine, tally: Tally | None = None) -> None:
        self._engine = engine
        self._store = SlopeStore(engine, tally)
        self._told: dict[str, int] = {}
        """How many runs each road had when it was told of."""

    def save(self, vehicle_id: str, record: Record) -> Sequence[RoadLearned]:
        """Merge a finished run, or keep what was left out; `look` tells of the run's road."""
        del vehicle_id
        self._store.save(record)
        return ()

    def of_vehicle(self, vehicle_id: str, limit: int) -> Kept:
        """What is kept of a vehicle's drives, so much of each at most."""
        with self._engine.connect() as connection:
            return kept_of(connection, vehicle_id, limit)

    def look(self) -> Sequence[RoadLearned]:
        """The roads that were written to since the last look, by this process or another."""
        counts = self._store.run_counts()
        changed = [road_id for road_id, count in counts.items() if self._told.get(road_id) != count]
        learned = [RoadLearned(self._store.load_road(road_id)) for road_id in changed]
        self._told = counts
        return learned
