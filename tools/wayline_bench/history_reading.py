"""Days of one vehicle in a history, read as HTTP does, and beside it a bare indexed query."""

import sqlite3
from collections.abc import Callable, Iterator
from pathlib import Path

import sqlalchemy as sa

from wayline.database import open_database
from wayline_bench.history_drives import SECOND_NS, START_NS, drive
from wayline_history.chunk import Chunk, chunk_of, encoded
from wayline_history.documents import json_track
from wayline_history.instants import DAY_NS, Stretch
from wayline_history.layouts import NULL, POSES
from wayline_history.points import points_of
from wayline_history.reading import HistoryReader
from wayline_history.store import SETTLED
from wayline_history.tables import CHUNKS, HOUR_US, HOURS, VEHICLES

VEHICLE = "bus-1"
DAY_S, HOURS_A_DAY, HOUR_S = 86_400, 24, 3_600


def fill(engine: sa.Engine, days: int) -> Iterator[int]:
    """Keep days of one vehicle as they are when their hours are over; the same day each time."""
    day = chunk_of(POSES, [POSES.row(pose, {}, engine=NULL) for pose in drive(DAY_S)])
    with engine.begin() as connection:
        connection.execute(sa.insert(VEHICLES).values(vehicle_no=1, vehicle_id=VEHICLE))
    for number in range(days):
        with engine.begin() as connection:
            for hour in range(HOURS_A_DAY):
                _keep(connection, day.taken(slice(hour * HOUR_S, (hour + 1) * HOUR_S)), number)
        yield number


def _keep(connection: sa.Connection, chunk: Chunk, day: int) -> None:
    values = chunk.values.copy()
    values[:, 0] += day * DAY_S * 1_000_000
    hour = int(values[0, 0]) // HOUR_US
    data = encoded(Chunk(POSES, values))
    kept = {"hour": hour, "vehicle_no": 1, "kind": POSES.number, "data": data}
    connection.execute(sa.insert(CHUNKS).values(**kept))
    size = {"hour": hour, "bytes": len(data), "written_s": 0, "state": SETTLED}
    connection.execute(sa.insert(HOURS).values(**size))


def filled_days(url: str) -> list[Chunk]:
    """The rows of a day of a history, an hour at a time."""
    engine = open_database(url, "wayline_history")
    span = START_NS, START_NS + DAY_S * SECOND_NS
    found = list(HistoryReader(engine).rows(VEHICLE, "fused", *span))
    engine.dispose()
    return found


def day_of(url: str, day: int) -> Callable[[], None]:
    """Reads a day as HTTP answers it, to its last byte."""
    reader = HistoryReader(open_database(url, "wayline_history"))
    stretch = Stretch(START_NS + day * DAY_NS, START_NS + (day + 1) * DAY_NS)

    def read() -> None:
        chunks = reader.rows(VEHICLE, "fused", *stretch)
        size = sum(map(len, json_track(VEHICLE, "fused", stretch, chunks, 2 * DAY_S)))
        if size < DAY_S:
            raise AssertionError(f"{size} bytes are no day")

    return read


class BareTrack:
    """The same points in a plain table with an index, a row a point."""

    def __init__(self, path: Path, chunks: list[Chunk]) -> None:
        self._connection = sqlite3.connect(path)
        self._connection.execute(
            "CREATE TABLE point (vehicle TEXT, t TEXT, lat REAL, lon REAL, alt REAL,"
            " heading REAL, speed REAL, grade REAL, distance REAL, mode TEXT, east REAL,"
            " north REAL, alt_std REAL)"
        )
        self._connection.execute("CREATE INDEX place ON point (vehicle, t)")
        for chunk in chunks:
            rows = [
                (VEHICLE, *(getattr(point, name) for name in point.__struct_fields__))
                for point in points_of(chunk)
            ]
            marks = ", ".join("?" * len(rows[0]))
            self._connection.executemany(f"INSERT INTO point VALUES ({marks})", rows)  # noqa: S608
        self._connection.commit()

    def read(self) -> None:
        """All points of the day in order of time."""
        query = "SELECT * FROM point WHERE vehicle = ? AND t >= ? AND t < ? ORDER BY t"
        rows = self._connection.execute(query, (VEHICLE, "1", "3")).fetchall()
        if len(rows) != DAY_S:
            raise AssertionError(f"{len(rows)} rows are no day")
