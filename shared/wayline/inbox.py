"""The bounded queue between threads that hear things and the one thread that works."""

import queue
import time
from typing import NamedTuple

import msgspec

CAPACITY = 20_000
"""Ten seconds of a busy vehicle; a loop that is further behind has lost anyway."""


class Sample(NamedTuple):
    """A payload from the bus."""

    key: str
    payload: bytes
    received_ns: int
    """Unix time."""
    heard_ns: int = 0
    """The instant of receipt by the monotonic clock."""


class Raw(NamedTuple):
    """Input of a vehicle that does not come over the bus."""

    vehicle_id: str
    source: str
    message: msgspec.Struct
    received_ns: int
    """Unix time."""
    heard_ns: int = 0
    """The instant of receipt by the monotonic clock."""


class Alive(NamedTuple):
    """A service's liveliness token came or went."""

    vehicle_id: str
    service: str
    up: bool


Item = Sample | Raw | Alive


class Inbox:
    """Putting never waits: what does not fit is dropped and counted.

    A SimpleQueue costs a tenth of a bounded Queue. Threads that put at one moment may each find the
    last place free, so the capacity may be exceeded by as many.
    """

    def __init__(self, capacity: int = CAPACITY) -> None:
        self._queue: queue.SimpleQueue[Item] = queue.SimpleQueue()
        self._capacity = capacity
        self.dropped = 0

    def put(self, item: Item) -> None:
        """Add an item from any thread."""
        if self._is_full():
            self.dropped += 1
        else:
            self._queue.put(item)

    def put_waiting(self, item: Item, pause_s: float) -> bool:
        """Add an item of a source that can wait, such as a file, after a pause if it must.

        False if there was no room then either. The pause should be shorter than what the loop
        takes over a full inbox, or that runs dry meanwhile.
        """
        if self._is_full():
            time.sleep(pause_s)
        if self._is_full():
            return False
        self._queue.put(item)
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

    def _is_full(self) -> bool:
        return self._queue.qsize() >= self._capacity
