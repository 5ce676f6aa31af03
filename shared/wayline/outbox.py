"""What is to be published waits for more, so that a busy service's messages go out together.

A message that goes alone wakes the router and every reader for itself, which costs them twice of
what it costs among twenty. A service that is not busy sends at once.
"""

import time
from collections.abc import Callable

TOGETHER = 64
"""So many messages do not wait for more."""
LONGEST_S = 0.005
"""Nor does what has waited so long."""

Put = Callable[[str, str, str, bytes], None]
"""Publishes a payload: `Publishers.put`, of vehicle, topic, source and payload."""


class Outbox:
    """Of one loop, in the order of adding."""

    def __init__(self, put: Put) -> None:
        self._put = put
        self._waiting: list[tuple[str, str, str, bytes]] = []
        self._since_s = 0.0

    @property
    def is_due(self) -> bool:
        """Whether something has waited for as long as it may."""
        return bool(self._waiting) and time.monotonic() - self._since_s >= LONGEST_S

    def add(self, vehicle_id: str, topic: str, source: str, payload: bytes) -> None:
        """Let a message wait; where many do already, they go."""
        if not self._waiting:
            self._since_s = time.monotonic()
        self._waiting.append((vehicle_id, topic, source, payload))
        if len(self._waiting) >= TOGETHER:
            self.send()

    def send(self) -> None:
        """Publish all that waits."""
        waiting, self._waiting = self._waiting, []
        for each in waiting:
            self._put(*each)
