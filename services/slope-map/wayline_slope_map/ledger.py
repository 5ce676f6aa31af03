"""The runs that a slope database has merged, by name."""

import hashlib
from collections.abc import Iterator
from typing import Any, NamedTuple

import sqlalchemy as sa

from wayline_slope_map.tables import LEDGER

LISTED = sa.select(
    LEDGER.c.vehicle_id,
    LEDGER.c.road_id,
    LEDGER.c.direction,
    LEDGER.c.start_ns,
    LEDGER.c.end_ns,
    LEDGER.c.withdrawn,
    LEDGER.c.kept.is_not(None).label("has_kept"),
)


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
        return list(in_order_of_time(connection))


def newest_runs(connection: sa.Connection, vehicle_id: str, limit: int) -> list[ListedRun]:
    """So many runs of a vehicle at most, the newest first."""
    of_vehicle = LISTED.where(LEDGER.c.vehicle_id == vehicle_id)
    newest = of_vehicle.order_by(LEDGER.c.start_ns.desc(), LEDGER.c.road_id, LEDGER.c.direction)
    return list(_read(connection, newest.limit(limit)))


def run_name(vehicle_id: str, road_id: str, direction: int, start_ns: int) -> str:
    """Ten letters for a run, alike wherever the run is merged."""
    text = f"{vehicle_id}\n{road_id}\n{direction}\n{start_ns}"
    return hashlib.blake2s(text.encode(), digest_size=5).hexdigest()


def in_order_of_time(connection: sa.Connection) -> Iterator[ListedRun]:
    """Every run, in order of time."""
    listed = LISTED.order_by(LEDGER.c.start_ns, LEDGER.c.vehicle_id, LEDGER.c.road_id)
    return _read(connection, listed)


def _read(connection: sa.Connection, query: sa.Select[Any]) -> Iterator[ListedRun]:
    for row in connection.execute(query):
        vehicle_id, road_id, direction, start_ns, end_ns, is_withdrawn, is_kept = row
        state = "withdrawn" if is_withdrawn else ("merged" if is_kept else "fixed")
        name = run_name(vehicle_id, road_id, direction, start_ns)
        yield ListedRun(name, vehicle_id, road_id, direction, start_ns, end_ns, state)
