"""Keeps the history in its database: pieces in batches, each as rows of its hours."""

from collections import Counter, defaultdict
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from itertools import groupby
from typing import NamedTuple

import msgspec
import sqlalchemy as sa
from sqlalchemy.dialects import postgresql, sqlite

from wayline.database import write_transaction
from wayline.messages import Trip
from wayline_history.chunk import chunk_of, encoded
from wayline_history.layouts import LAYOUTS, Kind
from wayline_history.records import Event, Piece, Rows
from wayline_history.tables import ALIVE, CHUNKS, DAY_HOURS, EVENTS, HOUR_US, HOURS, TRIPS, VEHICLES

ROW_BYTES = 60
"""What a row takes in the database besides its data, its place in the indices included."""
NS_PER_HOUR = 3_600_000_000_000
AS_IT_CAME, SETTLED, THINNED = 0, 1, 2


class KeptChunk(NamedTuple):
    """Rows of one hour, as they are stored."""

    hour: int
    kind: Kind
    data: bytes


class Alive(NamedTuple):
    """How far the history is kept, by the host's clock."""

    t_ns: int
    is_whole: bool
    """The cores had ended: nothing was on its way."""


class HistoryStore:
    """The history on an engine from `open_database(url, "wayline_history")`.

    `clock_s` is the host's Unix time, by which is reckoned how long something has been kept.
    """

    def __init__(self, engine: sa.Engine, clock_s: Callable[[], float]) -> None:
        self._engine, self._clock_s = engine, clock_s
        self._numbers: dict[str, int] = {}

    def save(self, pieces: Iterable[tuple[str, Piece]], alive: Alive | None = None) -> None:
        """Keep the pieces of vehicles durably before returning: all of them or none.

        `alive` is how far the history is kept with them.
        """
        pieces = list(pieces)
        chunks = [(vehicle, chunk) for vehicle, piece in pieces for chunk in _chunks(piece.rows)]
        with write_transaction(self._engine) as connection:
            numbers = self._numbered(connection, {vehicle for vehicle, _ in pieces})
            _make_partitions(connection, {chunk.hour for _, chunk in chunks})
            sizes = Counter[int]()
            for _, chunk in chunks:
                sizes[chunk.hour] += len(chunk.data) + ROW_BYTES
            _insert_chunks(connection, [(numbers[vehicle], chunk) for vehicle, chunk in chunks])
            for vehicle, piece in pieces:
                sizes += _put_events(connection, numbers[vehicle], piece.events)
                under_way = [] if piece.under_way is None else [piece.under_way]
                _put_trips(connection, numbers[vehicle], under_way, is_over=False)
                _put_trips(connection, numbers[vehicle], piece.trips, is_over=True)
            _add_sizes(connection, sizes, int(self._clock_s()))
            if alive is not None:
                _set_alive(connection, alive)
        self._numbers |= numbers

    def alive(self) -> Alive | None:
        """How far the history was kept; None of a new one."""
        with self._engine.connect() as connection:
            row = connection.execute(sa.select(ALIVE.c.t_ns, ALIVE.c.is_whole)).first()
        return None if row is None else Alive(*row)

    def _numbered(self, connection: sa.Connection, vehicle_ids: set[str]) -> Mapping[str, int]:
        """The numbers of vehicles; new ones get theirs."""
        unknown = sorted(vehicle_ids - self._numbers.keys())
        if not unknown:
            return self._numbers
        insert = _inserting(connection, VEHICLES).on_conflict_do_nothing()
        connection.execute(insert, [{"vehicle_id": each} for each in unknown])
        found = connection.execute(
            sa.select(VEHICLES.c.vehicle_id, VEHICLES.c.vehicle_no).where(
                VEHICLES.c.vehicle_id.in_(unknown)
            )
        )
        return self._numbers | {row[0]: row[1] for row in found}


def partition(day: int) -> str:
    """The name of PostgreSQL's table of a day since 1970."""
    return f"history_chunk_{day}"


def _make_partitions(connection: sa.Connection, hours: set[int]) -> None:
    if connection.dialect.name != "postgresql":
        return
    for day in sorted({hour // DAY_HOURS for hour in hours}):
        # asked each time: another process may have let an old day go
        if connection.execute(sa.select(sa.func.to_regclass(partition(day)))).scalar() is None:
            connection.exec_driver_sql(
                f"CREATE TABLE IF NOT EXISTS {partition(day)} PARTITION OF history_chunk "
                f"FOR VALUES FROM ({day * DAY_HOURS}) TO ({(day + 1) * DAY_HOURS})"
            )


def _chunks(rows: Mapping[Kind, Rows]) -> Iterator[KeptChunk]:
    for kind, each in rows.items():
        by_hour: dict[int, list[tuple[int, ...]]] = defaultdict(list)
        for hour, group in groupby(each.rows, lambda row: row[0] // HOUR_US):
            by_hour[hour].extend(group)
        for hour, of_hour in by_hour.items():
            data = encoded(chunk_of(LAYOUTS[kind], of_hour, each.texts))
            yield KeptChunk(hour, kind, data)


def _insert_chunks(connection: sa.Connection, chunks: Sequence[tuple[int, KeptChunk]]) -> None:
    if chunks:
        connection.execute(
            sa.insert(CHUNKS).inline(),
            [
                {
                    "hour": chunk.hour,
                    "vehicle_no": number,
                    "kind": LAYOUTS[chunk.kind].number,
                    "data": chunk.data,
                }
                for number, chunk in chunks
            ],
        )


def _put_events(connection: sa.Connection, number: int, events: Sequence[Event]) -> Counter[int]:
    """Keep events, those that are known already as they are now; how much each hour grows."""
    sizes = Counter[int]()
    rows = []
    for event in events:
        data, hour = msgspec.json.encode(event), event.t_ns // NS_PER_HOUR
        sizes[hour] += len(data) + ROW_BYTES
        rows.append(
            {
                "vehicle_no": number,
                "t_ns": event.t_ns,
                "kind": event.kind,
                "name": event.name,
                "hour": hour,
                "data": data,
            }
        )
    if rows:
        insert = _inserting(connection, EVENTS)
        keys = [EVENTS.c.vehicle_no, EVENTS.c.t_ns, EVENTS.c.kind, EVENTS.c.name]
        newer = {"data": insert.excluded.data}
        connection.execute(insert.on_conflict_do_update(index_elements=keys, set_=newer), rows)
    return sizes


def _put_trips(
    connection: sa.Connection, number: int, trips: Sequence[Trip], *, is_over: bool
) -> None:
    if not trips:
        return
    insert = _inserting(connection, TRIPS)
    newer = {name: insert.excluded[name] for name in ("data", "ended_ns", "is_over")}
    connection.execute(
        insert.on_conflict_do_update(index_elements=[TRIPS.c.trip_key], set_=newer),
        [
            {
                "trip_key": trip.trip_key,
                "vehicle_no": number,
                "started_ns": trip.started_ns,
                "ended_ns": trip.ended_ns,
                "is_over": is_over,
                "hour": trip.started_ns // NS_PER_HOUR,
                "data": msgspec.json.encode(trip),
            }
            for trip in trips
        ],
    )


def _add_sizes(connection: sa.Connection, sizes: Counter[int], written_s: int) -> None:
    if not sizes:
        return
    insert = _inserting(connection, HOURS)
    grown = {
        "bytes": HOURS.c.bytes + insert.excluded.bytes,
        "written_s": insert.excluded.written_s,
        "state": insert.excluded.state,
    }
    connection.execute(
        insert.on_conflict_do_update(index_elements=[HOURS.c.hour], set_=grown),
        [
            {"hour": hour, "bytes": size, "written_s": written_s, "state": AS_IT_CAME}
            for hour, size in sorted(sizes.items())
        ],
    )


def _set_alive(connection: sa.Connection, alive: Alive) -> None:
    insert = _inserting(connection, ALIVE).values(only=1, **alive._asdict())
    newer = {name: insert.excluded[name] for name in Alive._fields}
    connection.execute(insert.on_conflict_do_update(index_elements=[ALIVE.c.only], set_=newer))


def _inserting(connection: sa.Connection, table: sa.Table) -> sqlite.Insert | postgresql.Insert:
    is_sqlite = connection.dialect.name == "sqlite"
    return sqlite.insert(table) if is_sqlite else postgresql.insert(table)
