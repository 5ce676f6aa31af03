"""How old messages are when they come, and which are refused as they lie ahead (SPEC section 2)."""

import time
from collections.abc import Callable
from contextlib import AbstractContextManager, ExitStack

from wayline.ahead import AHEAD_NS, Ahead
from wayline.host_clock import HostClock
from wayline.inbox import Sample
from wayline.messages import Health, Message
from wayline.provenance import LATE_NS, Provenance
from wayline.settings import EVERY_VEHICLE
from wayline.view import Receipt

EACH_MAX = 16
"""So many vehicles are asked each by itself, which costs a subscription and a thread; of a fleet
whose reports are all old when they come, as agencies' are, everything is heard by one."""

Listen = Callable[[str], AbstractContextManager[object]]
"""Subscribes to the `health` of a vehicle, or of every one, until left."""


class Receipts:
    """Notes how old each message was when it came, and refuses those that lie ahead.

    Old times, and times ahead, may be those of a recording that is played. Which vehicles are
    recorded is said in `health`, which is asked for only where a vehicle's times differ from the
    host's.
    """

    def __init__(self, listen: Listen, host_clock: HostClock | None = None) -> None:
        self._listen = listen
        self._host_clock = host_clock or HostClock()
        self._provenance = Provenance()
        self._ahead = Ahead()
        self._listening: dict[str, ExitStack] = {}

    def note(self, vehicle_id: str, message: Message, sample: Sample) -> Receipt | None:
        """The receipt of a message that came in a sample; None where it is refused."""
        now = self._host_clock.now()
        if now is None:
            return Receipt(sample.heard_ns)
        # it may have waited here for long: that is no age
        waited_ns = time.monotonic_ns() - sample.heard_ns
        heard_s = sample.heard_ns * 1e-9
        behind_ns = now.earliest_ns - waited_ns - message.t_ns
        ahead_ns = message.t_ns - now.latest_ns + waited_ns
        if behind_ns >= LATE_NS or ahead_ns > AHEAD_NS:
            self._ask_whether_recorded(vehicle_id)
        is_refused = self._ahead.refuses(type(message), ahead_ns, heard_s)
        if is_refused and not self._provenance.is_recorded(vehicle_id):
            return None
        return Receipt(sample.heard_ns, self._provenance.age_ns(vehicle_id, behind_ns, heard_s))

    def _ask_whether_recorded(self, vehicle_id: str) -> None:
        if vehicle_id in self._listening or EVERY_VEHICLE in self._listening:
            return
        each = list(self._listening)
        if len(each) < EACH_MAX:
            self._listen_to(vehicle_id)
            return
        self._listen_to(EVERY_VEHICLE)
        for listened in each:
            self._listening.pop(listened).close()

    def _listen_to(self, vehicle_id: str) -> None:
        self._listening[vehicle_id] = stack = ExitStack()
        stack.enter_context(self._listen(vehicle_id))

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
