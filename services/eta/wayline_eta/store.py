"""Keeps what eta has learned in its database, row by row, so that it can be learned anew."""

from collections.abc import Sequence

import msgspec
import sqlalchemy as sa

from wayline.core import Record
from wayline.database import write_transaction
from wayline_eta.records import Came, Learned, Scored, Taken
from wayline_eta.score_store import add_scored, delete_old_scores, new_row, scored_days
from wayline_eta.tables import CAME, TAKEN

DAY_NS = 86_400 * 1_000_000_000
KEPT_NS = {TAKEN: 90 * DAY_NS, CAME: 7 * DAY_NS}
"""Before the newest; of how forecasts came the last ones say enough."""
PRUNED_EVERY = 5_000
"""Records; older rows are deleted then, and at a start."""
LEG_RUNS = 200
"""The newest of each leg are read at a start; the model forgets sooner."""
CAME_READ = 20_000


class EtaTables:
    """The rows of all vehicles, on an engine from `open_database(url, "wayline_eta")`.

    The same vehicle at the same instant is the same row, so a drive that is replayed twice teaches
    once.
    """

    def __init__(self, engine: sa.Engine) -> None:
        self._engine = engine
        self._is_told = False
        self._saved = 0

    def save(self, vehicle_id: str, record: Record) -> Sequence[msgspec.Struct]:
        """Keep what was learned; of scores the whole day's are answered."""
        known: list[msgspec.Struct] = []
        with write_transaction(self._engine) as connection:
            match record:
                case Learned():
                    _add_learned(connection, vehicle_id, record)
                case Scored():
                    known = [add_scored(connection, vehicle_id, record)]
                case _:
                    raise TypeError(f"eta keeps no {type(record).__name__}")
        self._saved += 1
        if self._saved % PRUNED_EVERY == 0:
            self._delete_old()
        return known

    def look(self) -> Sequence[msgspec.Struct]:
        """Everything that is kept, oldest first, once."""
        if self._is_told:
            return ()
        self._delete_old()
        with self._engine.connect() as connection:
            scored = scored_days(connection)
        found = [*self._taken(), *self._came(), *scored]
        self._is_told = True
        return found

    def _delete_old(self) -> None:
        with write_transaction(self._engine) as connection:
            for table, time in ((TAKEN, TAKEN.c.t_ns), (CAME, CAME.c.made_ns)):
                newest_ns = connection.execute(sa.select(sa.func.max(time))).scalar_one()
                if newest_ns is not None:
                    old = time < newest_ns - KEPT_NS[table]
                    connection.execute(sa.delete(table).where(old))
            delete_old_scores(connection)

    def _taken(self) -> list[Taken]:
        number = sa.func.row_number().over(
            partition_by=[TAKEN.c.stop, TAKEN.c.leg], order_by=TAKEN.c.t_ns.desc()
        )
        numbered = sa.select(TAKEN, number.label("number")).subquery()
        columns = [numbered.c[name] for name in Taken.__struct_fields__]
        query = (
            sa.select(*columns)
            .where(numbered.c.number <= LEG_RUNS)
            .order_by(numbered.c.t_ns, numbered.c.vehicle_id)
        )
        with self._engine.connect() as connection:
            return [Taken(*row) for row in connection.execute(query)]

    def _came(self) -> list[Came]:
        columns = [CAME.c[name] for name in Came.__struct_fields__]
        order = CAME.c.made_ns.desc(), CAME.c.vehicle_id.desc(), CAME.c.stop.desc()
        query = sa.select(*columns).order_by(*order).limit(CAME_READ)
        with self._engine.connect() as connection:
            return [Came(*row) for row in connection.execute(query)][::-1]


class EtaStore:
    """One vehicle's records, for a replay."""

    def __init__(self, tables: EtaTables, vehicle_id: str) -> None:
        self._tables, self._vehicle_id = tables, vehicle_id

    def save(self, record: Record) -> Sequence[msgspec.Struct]:
        """Keep what was learned; of scores the whole day's are answered."""
        return self._tables.save(self._vehicle_id, record)


def _add_learned(connection: sa.Connection, vehicle_id: str, learned: Learned) -> None:
    taken = {"vehicle_id": vehicle_id, **msgspec.structs.asdict(learned.taken)}
    connection.execute(new_row(connection, TAKEN), taken)
    if learned.came:
        rows = [{"vehicle_id": vehicle_id, **msgspec.structs.asdict(each)} for each in learned.came]
        connection.execute(new_row(connection, CAME), rows)
