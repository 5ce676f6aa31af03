"""The bounded queue between threads that hear things and the one thread that works."""

import queue
import threading
import time
from collections import Counter, deque
from typing import NamedTuple

import msgspec

CAPACITY = 20_000
"""Ten seconds of a busy vehicle; a loop that is further behind has lost anyway."""
HEAVY_BYTES = 4_096
"""A payload counts as one message for every so many bytes: 80 MB fill the inbox."""


class Sample(NamedTuple):
    """A payload from the bus."""

    key: str
    payload: bytes
    received_ns: int
    """Unix time."""
    heard_ns: int = 0
    """The instant of receipt by the monotonic clock."""

    @property
    def vehicle_id(self) -> str:
        """The vehicle's part of the key, whatever stands there."""
        return self.key.split("/", 3)[2]

    @property
    def weight(self) -> int:
        """How much of an inbox it takes."""
        return 1 + len(self.payload) // HEAVY_BYTES


class Raw(NamedTuple):
    """Input of a vehicle that does not come over the bus."""

    vehicle_id: str
    source: str
    message: msgspec.Struct
    received_ns: int
    """Unix time."""
    heard_ns: int = 0
    """The instant of receipt by the monotonic clock."""
    weight: int = 1
    """How much of an inbox it takes."""


class Alive(NamedTuple):
    """A service's liveliness token came or went."""

    vehicle_id: str
    service: str
    up: bool
    weight: int = 1
    """How much of an inbox it takes."""


Item = Sample | Raw | Alive


class Share:
    """What waits of one vehicle."""

    def __init__(self) -> None:
        self.items: deque[Item] = deque()
        self.weight = 0

    def add(self, item: Item) -> None:
        """Put an item behind the others."""
        self.items.append(item)
        self.weight += item.weight

    def take(self) -> Item:
        """The oldest item."""
        item = self.items.popleft()
        self.weight -= item.weight
        return item

    def give_up(self) -> int:
        """Drop the newest item; the weight that this frees."""
        weight = self.items.pop().weight
        self.weight -= weight
        return weight


class Inbox:
    """Putting never waits: what does not fit is dropped and counted.

    Vehicles take turns: of each the oldest item is next, so none waits for another's flood. Where
    there is no room, the vehicle that takes the most of it loses its newest.
    """

    def __init__(self, capacity: int = CAPACITY) -> None:
        self._capacity = capacity
        self._lock = threading.Lock()
        self._shares: dict[str, Share] = {}
        """Of vehicles of which something waits, whose turn it is first."""
        self._weight = 0
        # wakes whoever gets: waiting on it costs a tenth of waiting on a Condition
        self._arrivals: queue.SimpleQueue[None] = queue.SimpleQueue()
        self.backlog = 0
        """How many items wait."""
        self.dropped = 0
        self._dropped_of: Counter[str] = Counter()

    def put(self, item: Item) -> None:
        """Add an item from any thread."""
        vehicle_id, weight = item.vehicle_id, item.weight
        with self._lock:
            if self._weight + weight > self._capacity and not self._make_room(vehicle_id, weight):
                self._count_drop(vehicle_id)
                return
            share = self._shares.get(vehicle_id)
            if share is None:
                share = self._shares[vehicle_id] = Share()
            share.add(item)
            self._weight += weight
            self.backlog += 1
        if self._arrivals.empty():
            self._arrivals.put(None)

    def put_waiting(self, item: Item, pause_s: float) -> bool:
        """Add an item of a source that can wait, such as a file, after a pause if it must.

        False if there was no room then either. The pause should be shorter than what the loop
        takes over a full inbox, or that runs dry meanwhile.
        """
        if self._is_full():
            time.sleep(pause_s)
        if self._is_full():
            return False
        self.put(item)
        return True

    def get(self, timeout_s: float) -> Item | None:
        """The next item, None when nothing came in time; only one thread gets."""
        item = self._next()
        if item is None:
            try:
                self._arrivals.get(timeout=timeout_s)
            except queue.Empty:
                return None
            item = self._next()
        return item

    def holds(self, vehicle_id: str) -> bool:
        """Whether anything of a vehicle waits."""
        return vehicle_id in self._shares

    def take_dropped(self) -> Counter[str]:
        """How much was dropped of which vehicle since this was last asked."""
        with self._lock:
            dropped, self._dropped_of = self._dropped_of, Counter()
        return dropped

    def _next(self) -> Item | None:
        with self._lock:
            if not self._shares:
                return None
            vehicle_id = next(iter(self._shares))
            share = self._shares.pop(vehicle_id)
            item = share.take()
            self._weight -= item.weight
            self.backlog -= 1
            if share.items:
                self._shares[vehicle_id] = share
            return item

    def _make_room(self, vehicle_id: str, weight: int) -> bool:
        """Whether a vehicle's item fits once those that take more have given way."""
        own = self._shares.get(vehicle_id)
        own_weight = weight + (own.weight if own else 0)
        if own_weight * max(len(self._shares), 1) > self._capacity:
            return False
        while self._weight + weight > self._capacity:
            heaviest = max(self._shares, key=lambda name: self._shares[name].weight)
            share = self._shares[heaviest]
            self._weight -= share.give_up()
            self.backlog -= 1
            self._count_drop(heaviest)
            if not share.items:
                del self._shares[heaviest]
        return True

    def _count_drop(self, vehicle_id: str) -> None:
        self.dropped += 1
        self._dropped_of[vehicle_id] += 1

    def _is_full(self) -> bool:
        return self._weight >= self._capacity
