"""The history as HTTP reads it: opened when it is first asked for, and again where it was away."""

import threading
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from typing import TypeVar

import sqlalchemy as sa

from wayline.database import DatabaseAwayError, open_database, said
from wayline.query_error import QueryError
from wayline_history.reading import HistoryReader

Found = TypeVar("Found")


class Archive:
    """Reads of a database that may be away; used by many threads at once."""

    def __init__(self, url: str) -> None:
        self._url = url
        self._lock = threading.Lock()
        self._reader: HistoryReader | None = None

    def read(self, question: Callable[[HistoryReader], Found]) -> Found:
        """What the history answers. Raises QueryError (503) while its database is away."""
        with _said_as_query_error():
            return question(self._opened())

    def stream(self, question: Callable[[HistoryReader], Iterable[Found]]) -> Iterator[Found]:
        """The parts of a long answer, read as they are taken; raises as `read`, at any of them."""
        with _said_as_query_error():
            yield from question(self._opened())

    def _opened(self) -> HistoryReader:
        with self._lock:
            if self._reader is None:
                self._reader = HistoryReader(open_database(self._url, "wayline_history"))
            return self._reader


@contextmanager
def _said_as_query_error() -> Iterator[None]:
    try:
        yield
    except DatabaseAwayError as error:
        raise QueryError(503, f"the history's database is away ({error.what})") from None
    except sa.exc.DBAPIError as error:
        raise QueryError(503, f"the history's database is away ({said(error)})") from None
