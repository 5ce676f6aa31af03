"""Keeps timetables in a database by the hash of their feed, so that the next start is quick."""

import msgspec
import sqlalchemy as sa

from wayline.database import open_database, write_transaction
from wayline.timetable.model import Timetable

LAYOUT = 1
"""Raised whenever the Structs of `model` change: what was kept before is then read anew."""
KEPT = sa.table(
    "timetable_kept",
    sa.column("fingerprint", sa.Text),
    sa.column("content", sa.LargeBinary),
)


class KeptTimetables:
    """The timetables in a database. Raises InputError where it cannot be opened."""

    def __init__(self, url: str) -> None:
        self._engine = open_database(url, "wayline.timetable")

    def find(self, fingerprint: str) -> Timetable | None:
        """What was kept of a feed with this hash."""
        wanted = sa.select(KEPT.c.content).where(KEPT.c.fingerprint == _key(fingerprint))
        with self._engine.connect() as connection:
            content = connection.execute(wanted).scalar_one_or_none()
        return None if content is None else msgspec.msgpack.decode(content, type=Timetable)

    def keep(self, timetable: Timetable) -> None:
        """Keep a timetable, once."""
        key = _key(timetable.fingerprint)
        content = msgspec.msgpack.encode(timetable)
        with write_transaction(self._engine) as connection:
            there = sa.select(KEPT.c.fingerprint).where(KEPT.c.fingerprint == key)
            if connection.execute(there).first() is None:
                connection.execute(sa.insert(KEPT).values(fingerprint=key, content=content))

    def close(self) -> None:
        """Let go of the database."""
        self._engine.dispose()


def _key(fingerprint: str) -> str:
    return f"{LAYOUT}-{fingerprint}"
