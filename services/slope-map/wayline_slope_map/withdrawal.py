"""Takes merged runs out of a slope database again."""

import sqlalchemy as sa

from wayline.database import write_transaction
from wayline.errors import InputError
from wayline_slope_map.kept_run import unkept
from wayline_slope_map.ledger import ListedRun, in_order_of_time
from wayline_slope_map.merging import sums_of
from wayline_slope_map.sums import BinSums
from wayline_slope_map.tables import LEDGER, SUMS


def withdraw(engine: sa.Engine, run: str) -> ListedRun:
    """Take a run out of all sums; it stays in the ledger, so that it is not merged again.

    Raises InputError for a name that no run has, or one that cannot be withdrawn.
    """
    with write_transaction(engine) as connection:
        found = next((each for each in in_order_of_time(connection) if each.run == run), None)
        if found is None:
            raise InputError(run, "no run of this database", "`wayline slope list` names them")
        if found.state != "merged":
            raise InputError(run, _why_not(found.state), "withdraw another one")
        (data,) = connection.execute(sa.select(LEDGER.c.kept).where(_is(found))).one()
        for run_bin in unkept(data):
            _take_out(connection, found, run_bin.bin_index, run_bin.sensor, sums_of(run_bin, 0))
        connection.execute(sa.update(LEDGER).where(_is(found)).values(withdrawn=True))
    return found


def _why_not(state: str) -> str:
    return {
        "withdrawn": "has been withdrawn already",
        "fixed": "was merged before runs were kept, and cannot be taken out",
    }[state]


def _is(run: ListedRun) -> sa.ColumnElement[bool]:
    return sa.and_(
        LEDGER.c.vehicle_id == run.vehicle_id,
        LEDGER.c.road_id == run.road_id,
        LEDGER.c.direction == run.direction,
        LEDGER.c.start_ns == run.start_ns,
    )


def _take_out(
    connection: sa.Connection, run: ListedRun, bin_index: int, sensor: str, sums: BinSums
) -> None:
    """Subtract from one bin; a bin of no other run is gone."""
    here = sa.and_(
        SUMS.c.road_id == run.road_id,
        SUMS.c.direction == run.direction,
        SUMS.c.bin_index == bin_index,
        SUMS.c.sensor == sensor,
    )
    less = {name: SUMS.c[name] - getattr(sums, name) for name in BinSums._fields[:-1]}
    connection.execute(sa.update(SUMS).where(here).values(less))
    connection.execute(sa.delete(SUMS).where(here, SUMS.c.runs == 0))
