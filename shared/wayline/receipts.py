"""How old messages are when they come, by the older of two clocks (SPEC section 2)."""

import time
from collections.abc import Callable
from contextlib import AbstractContextManager, ExitStack

from wayline.host_clock import HostClock
from wayline.inbox import Sample
from wayline.messages import Health, Message
from wayline.provenance import LATE_NS, Provenance
from wayline.view import Receipt

Listen = Callable[[str], AbstractContextManager[object]]
"""Subscribes to the `health` of a vehicle until left."""


class Receipts:
    """Notes how old each message was when it came.

    Old times may be those of a recording that is played. Which vehicles are recorded is said in
    `health`, which is asked for only where a vehicle's times are old.
    """

    def __init__(self, listen: Listen, host_clock: HostClock | None = None) -> None:
        self._listen = listen
        self._host_clock = host_clock or HostClock()
        self._provenance = Provenance()
        self._listening: dict[str, ExitStack] = {}

    def note(self, vehicle_id: str, message: Message, sample: Sample) -> Receipt:
        """The receipt of a message that came in a sample."""
        now_ns = self._host_clock.now_ns()
        if now_ns is None:
            return Receipt(sample.heard_ns)
        # it may have waited here for long: that is no age
        waited_ns = time.monotonic_ns() - sample.heard_ns
        behind_ns = now_ns - waited_ns - message.t_ns
        if behind_ns >= LATE_NS and vehicle_id not in self._listening:
            self._listening[vehicle_id] = stack = ExitStack()
            stack.enter_context(self._listen(vehicle_id))
        age_ns = self._provenance.age_ns(vehicle_id, behind_ns, sample.heard_ns * 1e-9)
        return Receipt(sample.heard_ns, age_ns)

    def hear(self, vehicle_id: str, health: Health, source: str) -> None:
        """Take what a vehicle's service says of itself."""
        self._provenance.hear(vehicle_id, health, source)

    def forget(self, vehicle_id: str) -> None:
        """Drop what is known of a vehicle."""
        self._provenance.forget(vehicle_id)
        if listening := self._listening.pop(vehicle_id, None):
            listening.close()

    def close(self) -> None:
        """Listen to nobody any more."""
        for vehicle_id in list(self._listening):
            self.forget(vehicle_id)
