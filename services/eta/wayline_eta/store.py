"""Keeps what eta has learned in its database, row by row, so that it can be learned anew."""

from collections.abc import Sequence
from zoneinfo import ZoneInfo

import msgspec
import sqlalchemy as sa

from wayline.core import Record
from wayline.database import write_transaction
from wayline.spool import Waiting
from wayline_eta.known_store import add_taught, known
from wayline_eta.records import Came, Learned, Scored
from wayline_eta.score_store import add_scored, delete_old_scores, new_row, scored_days
from wayline_eta.tables import CAME, TAKEN

UTC = ZoneInfo("UTC")
DAY_NS = 86_400 * 1_000_000_000
KEPT_NS = {TAKEN: 90 * DAY_NS, CAME: 7 * DAY_NS}
"""Before the newest; of how forecasts came the last ones say enough."""
PRUNED_EVERY = 5_000
"""Records; older rows are deleted then, and at a start."""
CAME_READ = 20_000


class EtaTables:
    """The rows of all vehicles, on an engine from `open_database(url, "wayline_eta")`.

    The same vehicle at the same instant is the same row, so a drive that is replayed twice teaches
    once. `zone` is that of the days that are driven alike.
    """

    def __init__(self, engine: sa.Engine, zone: ZoneInfo = UTC) -> None:
        self._engine, self._zone = engine, zone
        self._is_told = False
        self._saved = 0

    def save(self, vehicle_id: str, record: Record) -> Sequence[msgspec.Struct]:
        """Keep what was learned; of scores the whole day's are answered."""
        return self.save_all([Waiting(vehicle_id, record)])

    def save_all(self, batch: Sequence[Waiting]) -> Sequence[msgspec.Struct]:
        """Keep what many vehicles have taught; all have their scores on the minute."""
        scored: list[tuple[str, Scored]] = []
        with write_transaction(self._engine) as connection:
            for vehicle_id, record in batch:
                match record:
                    case Learned():
                        _add_learned(connection, vehicle_id, record, self._zone)
                    case Scored():
                        scored.append((vehicle_id, record))
                    case _:
                        raise TypeError(f"eta keeps no {type(record).__name__}")
            answers = add_scored(connection, scored)
        before, self._saved = self._saved, self._saved + len(batch)
        if self._saved // PRUNED_EVERY > before // PRUNED_EVERY:
            self._delete_old()
        return answers

    def look(self) -> Sequence[msgspec.Struct]:
        """What is known, how forecasts came and how good they were, once."""
        if self._is_told:
            return ()
        self._delete_old()
        with write_transaction(self._engine) as connection:
            taught = known(connection, self._zone)
        with self._engine.connect() as connection:
            scored = scored_days(connection)
        found = [*taught, *self._came(), *scored]
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


def _add_learned(
    connection: sa.Connection, vehicle_id: str, learned: Learned, zone: ZoneInfo
) -> None:
    taken = {"vehicle_id": vehicle_id, **msgspec.structs.asdict(learned.taken)}
    added = new_row(connection, TAKEN).returning(TAKEN.c.t_ns)
    if connection.execute(added, taken).first() is not None:
        add_taught(connection, learned.taken, zone)
    if learned.came:
        rows = [{"vehicle_id": vehicle_id, **msgspec.structs.asdict(each)} for each in learned.came]
        connection.execute(new_row(connection, CAME), rows)
