"""Pure: records that wait for their database, in order, as many as fit."""

import itertools
from collections.abc import Callable, Hashable
from typing import NamedTuple

from wayline.core import Record

CAPACITY = 1_000
"""A run of slope over 5 km takes some 100 kB, and a vehicle makes a few an hour."""


class Waiting(NamedTuple):
    """A record, and the vehicle that it is of."""

    vehicle_id: str
    record: Record


class Spool:
    """First in, first out. What does not fit pushes the oldest out, which is counted as lost.

    With `newest_only` a record takes the place of the one that waits of its vehicle. `on_lost` is
    told what was pushed out.
    """

    def __init__(
        self,
        capacity: int = CAPACITY,
        *,
        newest_only: bool = False,
        on_lost: Callable[[Waiting], None] = lambda _: None,
    ) -> None:
        self._capacity, self._newest_only, self._on_lost = capacity, newest_only, on_lost
        self._waiting: dict[Hashable, Waiting] = {}
        self._numbers = itertools.count()
        self.lost = 0

    def __len__(self) -> int:
        return len(self._waiting)

    def put(self, waiting: Waiting) -> None:
        """Add a record at the end."""
        key: Hashable = waiting.vehicle_id if self._newest_only else next(self._numbers)
        if key not in self._waiting and len(self._waiting) >= self._capacity:
            self.lose(self._waiting.pop(next(iter(self._waiting))))
        self._waiting[key] = waiting

    def lose(self, waiting: Waiting) -> None:
        """Count one that is not kept."""
        self.lost += 1
        self._on_lost(waiting)

    def first(self) -> Waiting | None:
        """What has waited longest; it stays until it is taken out."""
        return next(iter(self._waiting.values()), None)

    def oldest(self, count: int) -> list[Waiting]:
        """So many that have waited longest; they stay until they are taken out."""
        return list(itertools.islice(self._waiting.values(), count))

    def take_out(self, waiting: Waiting) -> None:
        """Remove what `first` gave, unless something newer has taken its place meanwhile."""
        for key, each in self._waiting.items():
            if each is waiting:
                del self._waiting[key]
                return
