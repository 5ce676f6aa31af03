"""Pure: what views are: they store and format what cores decided, and decide nothing themselves."""

from collections.abc import Callable
from typing import NamedTuple, Protocol

from wayline.messages import Message

Clock = Callable[[], int]
"""Nanoseconds by a clock that only goes forward."""


class Receipt(NamedTuple):
    """When a message came, and how old it was then."""

    at_ns: int
    """By the host's monotonic clock."""
    age_ns: int = 0
    """Since its `t_ns`, by the host's clock; 0 where that clock or a recording cannot tell."""

    def age_s(self, now_ns: int) -> float:
        """Age of what the message tells, at an instant of the monotonic clock."""
        return (self.age_ns + max(now_ns - self.at_ns, 0)) * 1e-9


class View(Protocol):
    """Holds what HTTP and pages show. One thread calls its methods, others read meanwhile."""

    @property
    def reads(self) -> frozenset[type[Message]]:
        """Topics of the bus that it wants besides what its own service publishes."""
        ...

    def put(self, vehicle_id: str, message: Message, source: str, receipt: Receipt) -> None:
        """Take a message heard or published; `vehicle_id` may be `_fleet`."""
        ...

    def forget(self, vehicle_id: str) -> None:
        """Drop what is known of a vehicle: it has been silent for long."""
        ...
