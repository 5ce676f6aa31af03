"""Pure: records that wait for their database, in order, as many as fit."""

import itertools
from collections.abc import Hashable
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

    With `newest_only` a record takes the place of the one that waits of its vehicle.
    """

    def __init__(self, capacity: int = CAPACITY, *, newest_only: bool = False) -> None:
        self._capacity, self._newest_only = capacity, newest_only
        self._waiting: dict[Hashable, Waiting] = {}
        self._numbers = itertools.count()
        self.lost = 0

    def __len__(self) -> int:
        return len(self._waiting)

    def put(self, waiting: Waiting) -> None:
        """Add a record at the end."""
        key: Hashable = waiting.vehicle_id if self._newest_only else next(self._numbers)
        if key not in self._waiting and len(self._waiting) >= self._capacity:
            del self._waiting[next(iter(self._waiting))]
            self.lost += 1
        self._waiting[key] = waiting

    def first(self) -> Waiting | None:
        """What has waited longest; it stays until it is taken out."""
        return next(iter(self._waiting.values()), None)

    def take_out(self, waiting: Waiting) -> None:
        """Remove what `first` gave, unless something newer has taken its place meanwhile."""
        for key, each in self._waiting.items():
            if each is waiting:
                del self._waiting[key]
                return
