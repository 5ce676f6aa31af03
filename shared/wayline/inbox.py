"""The bounded queue between threads that hear things and the one thread that works."""

import queue
from typing import NamedTuple

import msgspec

CAPACITY = 20_000
"""Ten seconds of a busy vehicle; a loop that is further behind has lost anyway."""


class Sample(NamedTuple):
    """A payload from the bus."""

    key: str
    payload: bytes
    received_ns: int


class Raw(NamedTuple):
    """Input of a vehicle that does not come over the bus."""

    vehicle_id: str
    source: str
    message: msgspec.Struct
    received_ns: int


class Alive(NamedTuple):
    """A service's liveliness token came or went."""

    vehicle_id: str
    service: str
    up: bool


Item = Sample | Raw | Alive


class Inbox:
    """Putting never waits: what does not fit is dropped and counted."""

    def __init__(self, capacity: int = CAPACITY) -> None:
        self._queue: queue.Queue[Item] = queue.Queue(capacity)
        self.dropped = 0

    def put(self, item: Item) -> None:
        """Add an item from any thread."""
        try:
            self._queue.put_nowait(item)
        except queue.Full:
            self.dropped += 1

    def put_waiting(self, item: Item, timeout_s: float) -> bool:
        """Add an item of a source that can wait, such as a file; False if there was no room."""
        try:
            self._queue.put(item, timeout=timeout_s)
        except queue.Full:
            return False
        return True

    def get(self, timeout_s: float) -> Item | None:
        """The next item, None when nothing came in time."""
        try:
            return self._queue.get(timeout=timeout_s)
        except queue.Empty:
            return None

    @property
    def backlog(self) -> int:
        """How many items wait."""
        return self._queue.qsize()
