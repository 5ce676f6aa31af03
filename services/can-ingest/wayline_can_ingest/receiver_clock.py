"""What time it is where the computer's own clock is behind: the time of its receiver."""

import time
from collections.abc import Collection
from typing import ClassVar

from wayline.ahead import AHEAD_NS
from wayline.messages import GpsFix, Message
from wayline.view import Receipt

WINDOW_NS = 60_000_000_000
"""The fastest fix of so long tells best; clocks drift apart by little meanwhile."""


class ReceiverClock:
    """Unix time of the host, or of the vehicle's receiver while the host's is far behind it.

    A clock without a battery starts in 1970 or at its last shutdown. A fix that is ahead of a
    plausible clock only comes here once that clock is overruled (`wayline.ahead`). A host that is
    ahead of its receiver keeps its time: the receiver's may be late.

    `own_sources` are the names of the fixes that the service itself publishes: they have the time
    of the frames that this clock is asked for. `latency_s` is what fixes had taken off.
    """

    reads: ClassVar[frozenset[type[Message]]] = frozenset({GpsFix})

    def __init__(self, own_sources: Collection[str], latency_s: float) -> None:
        self._own_sources, self._latency_ns = own_sources, round(latency_s * 1e9)
        self._since_ns = 0
        self._newest_ns: int | None = None
        """Unix time at the start of the monotonic clock, by the fastest fix of the window."""
        self._before_ns: int | None = None
        """Unix time at that start by the fastest fix of the window before."""

    def put(self, vehicle_id: str, message: Message, source: str, receipt: Receipt) -> None:
        """Take a fix; others are ignored."""
        del vehicle_id
        if not isinstance(message, GpsFix) or not message.valid or source in self._own_sources:
            return
        offset_ns = message.t_ns + self._latency_ns - receipt.at_ns
        if self._newest_ns is None or receipt.at_ns - self._since_ns > WINDOW_NS:
            self._before_ns, self._newest_ns = self._newest_ns, offset_ns
            self._since_ns = receipt.at_ns
        self._newest_ns = max(self._newest_ns, offset_ns)

    def forget(self, vehicle_id: str) -> None:
        """A receiver that is silent has told the time all the same."""

    def now_ns(self) -> int:
        """Nanoseconds since 1970: the host's, or the receiver's where the host's is far behind."""
        wall_ns = time.time_ns()
        told_ns = [ns for ns in (self._newest_ns, self._before_ns) if ns is not None]
        receiver_ns = time.monotonic_ns() + max(told_ns) if told_ns else wall_ns
        return receiver_ns if receiver_ns - wall_ns > AHEAD_NS else wall_ns
