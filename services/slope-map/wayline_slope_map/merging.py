"""Merges runs into the sums of a slope database, each once."""

import json
from collections.abc import Sequence

import sqlalchemy as sa
from sqlalchemy.dialects import postgresql, sqlite

from wayline_slope_map.kept_run import kept, unkept
from wayline_slope_map.records import FinishedRun, RunBin
from wayline_slope_map.roads import Road
from wayline_slope_map.sums import BinSums, run_sums
from wayline_slope_map.tables import LEDGER, ROADS, SUMS


def merge(connection: sa.Connection, run: FinishedRun) -> bool:
    """Merge a run within a transaction; False where the ledger has it, or one of its time."""
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
    _add_all(connection, _sum_rows(run, unkept(data)))
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


def _add_all(connection: sa.Connection, rows: list[dict[str, object]]) -> None:
    """Add rows of sums; handed to the driver at once, thousands take a fifth of the time."""
    adding = _adding(connection).compile(dialect=connection.dialect)
    names = adding.positiontup
    if names is None:
        connection.exec_driver_sql(adding.string, rows)
    else:
        connection.exec_driver_sql(adding.string, [tuple(row[n] for n in names) for row in rows])


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


def _road_row(road: Road) -> dict[str, object]:
    return {
        "road_id": road.road_id,
        "bin_m": road.bin_m,
        "loop": road.loop,
        "is_route": road.is_route,
        "line": json.dumps(road.points),
    }
