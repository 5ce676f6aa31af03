"""Keeps what was left out of the map: the newest of each vehicle, once."""

from collections.abc import Iterator

import msgspec
import sqlalchemy as sa
from sqlalchemy.dialects import postgresql, sqlite

from wayline_slope_map.left_out import LeftOut
from wayline_slope_map.tables import LEFT_OUT

KEPT = 1_000
"""Parts of a vehicle: some weeks of a bus whose every trip ends in a yard."""


def keep(connection: sa.Connection, left_out: LeftOut) -> None:
    """Keep a part, unless it is kept already, and let go of the vehicle's oldest beyond `KEPT`."""
    is_sqlite = connection.dialect.name == "sqlite"
    insert = sqlite.insert(LEFT_OUT) if is_sqlite else postgresql.insert(LEFT_OUT)
    row = {**msgspec.structs.asdict(left_out), "sensor": left_out.sensor or ""}
    connection.execute(insert.on_conflict_do_nothing(), row)
    oldest = (
        sa.select(LEFT_OUT.c.start_ns)
        .where(LEFT_OUT.c.vehicle_id == left_out.vehicle_id)
        .order_by(LEFT_OUT.c.start_ns.desc())
        .offset(KEPT - 1)
        .limit(1)
        .scalar_subquery()
    )
    mine = LEFT_OUT.c.vehicle_id == left_out.vehicle_id
    connection.execute(sa.delete(LEFT_OUT).where(mine, LEFT_OUT.c.start_ns < oldest))


def newest(connection: sa.Connection, vehicle_id: str, limit: int) -> list[LeftOut]:
    """What was left out of a vehicle's drives, the newest first."""
    query = (
        sa.select(LEFT_OUT)
        .where(LEFT_OUT.c.vehicle_id == vehicle_id)
        .order_by(LEFT_OUT.c.start_ns.desc(), LEFT_OUT.c.sensor, LEFT_OUT.c.reason)
        .limit(limit)
    )
    return list(_read(connection, query))


def every(connection: sa.Connection) -> list[LeftOut]:
    """What was left out of all drives, in order of time."""
    columns = LEFT_OUT.c.start_ns, LEFT_OUT.c.vehicle_id, LEFT_OUT.c.sensor, LEFT_OUT.c.reason
    return list(_read(connection, sa.select(LEFT_OUT).order_by(*columns)))


def _read(connection: sa.Connection, query: sa.Select[tuple[object, ...]]) -> Iterator[LeftOut]:
    for row in connection.execute(query).mappings():
        # SQLAlchemy's names are strings of a kind that msgspec does not take
        values = {str(name): value for name, value in row.items()}
        yield msgspec.convert({**values, "sensor": values["sensor"] or None}, LeftOut)
