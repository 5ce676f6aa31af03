"""Takes merged runs out of a slope database again, and lists them."""

import hashlib
from collections.abc import Iterator
from typing import NamedTuple

import sqlalchemy as sa

from wayline.database import write_transaction
from wayline.errors import InputError
from wayline_slope_map.kept_run import unkept
from wayline_slope_map.store import sums_of
from wayline_slope_map.sums import BinSums
from wayline_slope_map.tables import LEDGER, SUMS


class ListedRun(NamedTuple):
    """A run of the ledger."""

    run: str
    """Its name: made of vehicle, road, direction and begin, alike in every database."""
    vehicle_id: str
    road_id: str
    direction: int
    start_ns: int
    end_ns: int
    state: str
    """merged, withdrawn, or fixed: merged before runs were kept."""


def listed_runs(engine: sa.Engine) -> list[ListedRun]:
    """Every run, in order of time."""
    with engine.connect() as connection:
        return list(_listed(connection))


def withdraw(engine: sa.Engine, run: str) -> ListedRun:
    """Take a run out of all sums; it stays in the ledger, so that it is not merged again.

    Raises InputError for a name that no run has, or one that cannot be withdrawn.
    """
    with write_transaction(engine) as connection:
        found = next((each for each in _listed(connection) if each.run == run), None)
        if found is None:
            raise InputError(run, "no run of this database", "`wayline slope list` names them")
        if found.state != "merged":
            raise InputError(run, _why_not(found.state), "withdraw another one")
        (data,) = connection.execute(sa.select(LEDGER.c.kept).where(_is(found))).one()
        for run_bin in unkept(data):
            _take_out(connection, found, run_bin.bin_index, run_bin.sensor, sums_of(run_bin, 0))
        connection.execute(sa.update(LEDGER).where(_is(found)).values(withdrawn=True))
    return found


def run_name(vehicle_id: str, road_id: str, direction: int, start_ns: int) -> str:
    """Ten letters for a run, alike wherever the run is merged."""
    text = f"{vehicle_id}\n{road_id}\n{direction}\n{start_ns}"
    return hashlib.blake2s(text.encode(), digest_size=5).hexdigest()


def _listed(connection: sa.Connection) -> Iterator[ListedRun]:
    has_kept = LEDGER.c.kept.is_not(None).label("has_kept")
    query = sa.select(
        LEDGER.c.vehicle_id,
        LEDGER.c.road_id,
        LEDGER.c.direction,
        LEDGER.c.start_ns,
        LEDGER.c.end_ns,
        LEDGER.c.withdrawn,
        has_kept,
    ).order_by(LEDGER.c.start_ns, LEDGER.c.vehicle_id, LEDGER.c.road_id)
    for row in connection.execute(query):
        vehicle_id, road_id, direction, start_ns, end_ns, is_withdrawn, is_kept = row
        state = "withdrawn" if is_withdrawn else ("merged" if is_kept else "fixed")
        name = run_name(vehicle_id, road_id, direction, start_ns)
        yield ListedRun(name, vehicle_id, road_id, direction, start_ns, end_ns, state)


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
