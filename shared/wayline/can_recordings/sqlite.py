"""python-can's .db: a table of frames in SQLite."""

import sqlite3
from collections.abc import Iterator
from pathlib import Path

import can

from wayline.errors import UnreadableError
from wayline.log_file import LogFile


class Sqlite:
    """Frames of a .db, up to where it is damaged."""

    MAGIC = b"SQLite format 3\0"
    is_local = False
    is_dated = None
    first_channel = 0

    def __init__(self, path: Path) -> None:
        with LogFile(path) as log:
            if log.is_packed:
                raise UnreadableError(str(path), "is a packed database", "unpack it")
        self._path = path
        self.damaged = 0

    def __iter__(self) -> Iterator[can.Message]:
        count = 0
        try:
            with can.SqliteReader(self._path) as reader:
                for message in reader:
                    count += 1
                    if is_frame(message):
                        yield message
                    else:
                        self.damaged += 1
        except (sqlite3.Error, ValueError, TypeError, OverflowError) as error:
            if not count:
                what = f"is no SQLite database of python-can ({error})"
                raise UnreadableError(str(self._path), what, "give another recording") from None
            self.damaged += 1

    def close(self) -> None:
        """The database is closed at the end of the iteration."""


def is_frame(message: can.Message) -> bool:
    """Whether the cells of a row are what they should be: a damaged database has any."""
    return isinstance(message.timestamp, int | float) and isinstance(message.arbitration_id, int)
