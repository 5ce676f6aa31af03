"""Keeps how good predictions were: sums by route and day, each minute of a vehicle once."""

from collections.abc import Sequence

import msgspec
import sqlalchemy as sa
from sqlalchemy.dialects import postgresql, sqlite

from wayline_eta.records import DAY_NS, SCORED_DAYS_MAX, Scored, ScoredDay, day_of
from wayline_eta.scores import Sums
from wayline_eta.tables import SCORED_DAYS, SCORED_MINUTES

MINUTES_KEPT_NS = 7 * DAY_NS
"""Before the newest."""


def add_scored(connection: sa.Connection, scored: Sequence[tuple[str, Scored]]) -> list[ScoredDay]:
    """Add vehicles' minutes to their days, unless these hold them already; the whole days then."""
    added = {(day_of(each.t_ns), each.route_id): Sums() for _, each in scored}
    for vehicle_id, each in scored:
        if _is_new(connection, vehicle_id, each):
            key = day_of(each.t_ns), each.route_id
            added[key] = added[key].plus(each.sums)
    return [_add_to_day(connection, *key, added[key]) for key in sorted(added)]


def _is_new(connection: sa.Connection, vehicle_id: str, scored: Scored) -> bool:
    minute = {"vehicle_id": vehicle_id, "t_ns": scored.t_ns, "route_id": scored.route_id}
    added = new_row(connection, SCORED_MINUTES).returning(SCORED_MINUTES.c.t_ns)
    return connection.execute(added, minute).first() is not None


def _add_to_day(connection: sa.Connection, day: int, route_id: str, more: Sums) -> ScoredDay:
    key = {"route_id": route_id, "day": day}
    connection.execute(
        new_row(connection, SCORED_DAYS), {**key, "sums": msgspec.json.encode(Sums())}
    )
    is_day = sa.and_(*(SCORED_DAYS.c[name] == value for name, value in key.items()))
    query = sa.select(SCORED_DAYS.c.sums).where(is_day).with_for_update()
    before = msgspec.json.decode(connection.execute(query).scalar_one(), type=Sums)
    sums = before.plus(more)
    update = sa.update(SCORED_DAYS).where(is_day)
    connection.execute(update.values(sums=msgspec.json.encode(sums)))
    return ScoredDay(day, route_id, sums)


def scored_days(connection: sa.Connection) -> list[ScoredDay]:
    """All that is kept, oldest first."""
    table = SCORED_DAYS.c
    query = sa.select(table.day, table.route_id, table.sums).order_by(table.day, table.route_id)
    return [
        ScoredDay(day, route_id, msgspec.json.decode(sums, type=Sums))
        for day, route_id, sums in connection.execute(query)
    ]


def delete_old_scores(connection: sa.Connection) -> None:
    """Those of long before the newest."""
    newest_day = connection.execute(sa.select(sa.func.max(SCORED_DAYS.c.day))).scalar_one()
    if newest_day is not None:
        old = SCORED_DAYS.c.day <= newest_day - SCORED_DAYS_MAX
        connection.execute(sa.delete(SCORED_DAYS).where(old))
    newest_ns = connection.execute(sa.select(sa.func.max(SCORED_MINUTES.c.t_ns))).scalar_one()
    if newest_ns is not None:
        old = SCORED_MINUTES.c.t_ns < newest_ns - MINUTES_KEPT_NS
        connection.execute(sa.delete(SCORED_MINUTES).where(old))


def new_row(connection: sa.Connection, table: sa.Table) -> sqlite.Insert | postgresql.Insert:
    """A row; one that is there already stays as it is."""
    is_sqlite = connection.dialect.name == "sqlite"
    insert = sqlite.insert(table) if is_sqlite else postgresql.insert(table)
    return insert.on_conflict_do_nothing()
