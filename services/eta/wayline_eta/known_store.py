"""Keeps what all rows have taught so far, key by key, so that a start need not read them."""

from collections import defaultdict
from zoneinfo import ZoneInfo

import sqlalchemy as sa
from sqlalchemy.dialects import postgresql, sqlite

from wayline_eta.experience import MODEL, teachings
from wayline_eta.forgetful import Forgetful
from wayline_eta.records import Known, Taken
from wayline_eta.tables import KNOWN, TAKEN

MODEL_KEY = "model"
"""Under it stands which model the others are of."""
AT_A_TIME = 1_000
"""Rows."""


def add_taught(connection: sa.Connection, taken: Taken, zone: ZoneInfo) -> None:
    """Add what a row teaches that is not counted yet."""
    taught = dict(teachings(taken, zone))
    query = sa.select(KNOWN).where(KNOWN.c.key.in_(taught)).with_for_update()
    before = {row.key: Forgetful(*row[1:]) for row in connection.execute(query)}
    after = {key: before.get(key, Forgetful()).with_value(value) for key, value in taught.items()}
    _put(connection, after)


def known(connection: sa.Connection, zone: ZoneInfo) -> list[Known]:
    """All that is known; by another model's, or none, it is learned anew from the raw rows."""
    model = sa.select(KNOWN.c.weight).where(KNOWN.c.key == MODEL_KEY)
    if connection.execute(model).scalar_one_or_none() != MODEL:
        _learn_anew(connection, zone)
    rows = connection.execute(sa.select(KNOWN).where(KNOWN.c.key != MODEL_KEY))
    return [Known(*row) for row in rows]


def _learn_anew(connection: sa.Connection, zone: ZoneInfo) -> None:
    columns = [TAKEN.c[name] for name in Taken.__struct_fields__]
    query = sa.select(*columns).order_by(TAKEN.c.t_ns, TAKEN.c.vehicle_id)
    learned: defaultdict[str, Forgetful] = defaultdict(Forgetful)
    for row in connection.execute(query, execution_options={"yield_per": AT_A_TIME}):
        for key, value in teachings(Taken(*row), zone):
            learned[key] = learned[key].with_value(value)
    connection.execute(sa.delete(KNOWN))
    _put(connection, {**learned, MODEL_KEY: Forgetful(float(MODEL))})


def _put(connection: sa.Connection, rows: dict[str, Forgetful]) -> None:
    is_sqlite = connection.dialect.name == "sqlite"
    insert = sqlite.insert(KNOWN) if is_sqlite else postgresql.insert(KNOWN)
    changed = {name: insert.excluded[name] for name in Forgetful.__struct_fields__}
    put = insert.on_conflict_do_update(index_elements=[KNOWN.c.key], set_=changed)
    values = [
        {"key": key, "weight": each.weight, "mean": each.mean, "square": each.square}
        for key, each in sorted(rows.items())
    ]
    if values:
        connection.execute(put, values)
