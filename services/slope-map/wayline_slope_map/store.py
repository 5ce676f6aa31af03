"""Keeps the slope map in its database: merges each run once, into sums that do not grow."""

import json
from collections import defaultdict
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import sqlalchemy as sa
from sqlalchemy.dialects import postgresql, sqlite

from wayline.core import Record
from wayline.database import write_transaction
from wayline_slope_map.drives import Kept, kept_of
from wayline_slope_map.judging import Grades, Judgement, judged
from wayline_slope_map.kept_run import kept, unkept
from wayline_slope_map.left_out import COUNTED, LeftOut
from wayline_slope_map.left_out_rows import keep
from wayline_slope_map.profile import RoadProfile
from wayline_slope_map.records import DrivenRun, FinishedRun, RoadLearned, RunBin
from wayline_slope_map.roads import Road
from wayline_slope_map.run import outcome
from wayline_slope_map.sums import BinEstimate, BinSums, estimate, run_sums, without
from wayline_slope_map.tables import LEDGER, ROADS, SUMS
from wayline_slope_map.tally import Tally

FUSED = "fused"
Estimates = dict[int, dict[int, BinEstimate]]


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
            if not _merge(connection, record):
                self._tally.count(COUNTED)
                return []
            estimates = _estimates(connection, record.road.road_id)[record.road.road_id]
        return [RoadLearned(RoadProfile(record.road, estimates))]

    def load_roads(self) -> list[RoadProfile]:
        """Every road with its fused bins, in order of id."""
        with self._engine.connect() as connection:
            roads = _roads(connection)
            estimates = _estimates(connection)
        return [RoadProfile(road, estimates[road.road_id]) for road in roads]

    def load_road(self, road_id: str) -> RoadProfile:
        """One road that is there, with its fused bins."""
        with self._engine.connect() as connection:
            (road,) = _roads(connection, road_id)
            return RoadProfile(road, _estimates(connection, road_id)[road_id])

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


def _merge(connection: sa.Connection, run: FinishedRun) -> bool:
    known = connection.execute(
        sa.select(ROADS.c.road_id).where(ROADS.c.road_id == run.road.road_id)
    ).first()
    if _is_counted(connection, run, on_any_road=known is None):
        return False
    if known is None:
        connection.execute(sa.insert(ROADS).values(_road_row(run.road)))
    data = kept(run.bins)
    connection.execute(
        sa.insert(LEDGER).values(
            vehicle_id=run.vehicle_id,
            road_id=run.road.road_id,
            direction=run.direction,
            start_ns=run.start_ns,
            end_ns=run.end_ns,
            kept=data,
            withdrawn=False,
        )
    )
    connection.execute(_adding(connection), _sum_rows(run, unkept(data)))
    return True


def _is_counted(connection: sa.Connection, run: FinishedRun, *, on_any_road: bool) -> bool:
    """Whether the ledger has a run of this vehicle at this time, here or on any road.

    A new road that would be made of a time already counted is the same drive, cut otherwise.
    """
    overlapping = sa.select(LEDGER.c.start_ns).where(
        LEDGER.c.vehicle_id == run.vehicle_id,
        LEDGER.c.start_ns < run.end_ns,
        LEDGER.c.end_ns > run.start_ns,
    )
    if not on_any_road:
        overlapping = overlapping.where(
            LEDGER.c.road_id == run.road.road_id, LEDGER.c.direction == run.direction
        )
    return connection.execute(overlapping.limit(1)).first() is not None


def _sum_rows(run: FinishedRun, bins: Sequence[RunBin]) -> list[dict[str, object]]:
    return [
        {
            "road_id": run.road.road_id,
            "direction": run.direction,
            "bin_index": run_bin.bin_index,
            "sensor": run_bin.sensor,
            **sums_of(run_bin, run.end_ns)._asdict(),
        }
        for run_bin in bins
    ]


def sums_of(run_bin: RunBin, t_ns: int) -> BinSums:
    """What a run that ended at an instant adds to a bin."""
    return run_sums(
        run_bin.grade_pct, run_bin.grade_std_pct, run_bin.alt_m, run_bin.alt_std_m, t_ns
    )


def _adding(connection: sa.Connection) -> sa.Insert:
    """Insert a bin's sums, or add them to those that are there; the later time stands."""
    is_sqlite = connection.dialect.name == "sqlite"
    insert = sqlite.insert(SUMS) if is_sqlite else postgresql.insert(SUMS)
    greatest = sa.func.max if is_sqlite else sa.func.greatest
    added = {name: SUMS.c[name] + insert.excluded[name] for name in BinSums._fields[:-1]}
    later = greatest(SUMS.c.updated_ns, insert.excluded.updated_ns)
    return insert.on_conflict_do_update(
        index_elements=[SUMS.c.road_id, SUMS.c.direction, SUMS.c.bin_index, SUMS.c.sensor],
        set_={**added, "updated_ns": later},
    )


class KeptRuns(NamedTuple):
    """The runs of a road in one direction, in order of their beginning."""

    bins: tuple[Mapping[int, RunBin], ...]
    """By all sensors."""
    ends_ns: tuple[int, ...]

    def judgement(self, bin_m: float) -> Judgement:
        """What they say of each other."""
        grades = [
            Grades({i: (each.grade_pct, each.grade_std_pct) for i, each in run.items()})
            for run in self.bins
        ]
        return judged(grades, bin_m)


def _estimates(connection: sa.Connection, road_id: str | None = None) -> dict[str, Estimates]:
    query = sa.select(
        SUMS.c.road_id,
        SUMS.c.direction,
        SUMS.c.bin_index,
        *(SUMS.c[name] for name in BinSums._fields),
    ).where(SUMS.c.sensor == FUSED)
    if road_id is not None:
        query = query.where(SUMS.c.road_id == road_id)
    sums: dict[tuple[str, int], dict[int, BinSums]] = defaultdict(dict)
    for row_road_id, direction, bin_index, *values in connection.execute(query):
        sums[row_road_id, direction][bin_index] = BinSums(*values)
    runs, bins_m = _kept_runs(connection, road_id), _bins_m(connection)
    found: dict[str, Estimates] = defaultdict(lambda: defaultdict(dict))
    for (row_road_id, direction), by_bin in sums.items():
        of_way = runs.get((row_road_id, direction), KeptRuns((), ()))
        found[row_road_id][direction] = _judged_estimates(by_bin, of_way, bins_m[row_road_id])
    return found


def _judged_estimates(
    sums: Mapping[int, BinSums], runs: KeptRuns, bin_m: float
) -> dict[int, BinEstimate]:
    """What the bins say without their outliers."""
    flagged, common_share = runs.judgement(bin_m)
    estimates = {}
    for bin_index, of_all in sums.items():
        left, count = of_all, 0
        for run, end_ns, outlying in zip(runs.bins, runs.ends_ns, flagged, strict=True):
            if bin_index in outlying:
                left, count = without(left, sums_of(run[bin_index], end_ns)), count + 1
        estimates[bin_index] = estimate(left, common_share, count)
    return estimates


def _kept_runs(connection: sa.Connection, road_id: str | None) -> dict[tuple[str, int], KeptRuns]:
    query = (
        sa.select(LEDGER.c.road_id, LEDGER.c.direction, LEDGER.c.end_ns, LEDGER.c.kept)
        .where(LEDGER.c.kept.is_not(None), sa.not_(LEDGER.c.withdrawn))
        .order_by(LEDGER.c.start_ns, LEDGER.c.vehicle_id)
    )
    if road_id is not None:
        query = query.where(LEDGER.c.road_id == road_id)
    found: dict[tuple[str, int], KeptRuns] = {}
    for of_road_id, direction, end_ns, data in connection.execute(query):
        before = found.get((of_road_id, direction), KeptRuns((), ()))
        fused = {each.bin_index: each for each in unkept(data) if each.sensor == FUSED}
        found[of_road_id, direction] = KeptRuns((*before.bins, fused), (*before.ends_ns, end_ns))
    return found


def _bins_m(connection: sa.Connection) -> dict[str, float]:
    return {row[0]: row[1] for row in connection.execute(sa.select(ROADS.c.road_id, ROADS.c.bin_m))}


def _road_row(road: Road) -> dict[str, object]:
    return {
        "road_id": road.road_id,
        "bin_m": road.bin_m,
        "loop": road.loop,
        "is_route": road.is_route,
        "line": json.dumps(road.points),
    }


def _roads(connection: sa.Connection, road_id: str | None = None) -> list[Road]:
    query = sa.select(ROADS).order_by(ROADS.c.road_id)
    if road_id is not None:
        query = query.where(ROADS.c.road_id == road_id)
    return [
        Road(
            row.road_id,
            row.bin_m,
            row.loop,
            row.is_route,
            tuple((lat_deg, lon_deg) for lat_deg, lon_deg in json.loads(row.line)),
        )
        for row in connection.execute(query)
    ]
