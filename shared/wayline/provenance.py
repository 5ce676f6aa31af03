"""Pure: which vehicles' times may be old because a recording is played (SPEC section 2)."""

from wayline.messages import Health

LATE_NS = 10_000_000_000
"""Messages this much behind are late, or of a recording."""
UNKNOWN_S = 5.0
"""Health comes once a second; until it has, what is behind is not judged."""


class Provenance:
    """Ages of messages by the host's clock: a recorded vehicle's are as fresh as they come."""

    def __init__(self) -> None:
        self._recorded: dict[str, set[str]] = {}
        """By vehicle, whose health was heard: the sources that play a recording."""
        self._late_since_s: dict[str, float] = {}

    def hear(self, vehicle_id: str, health: Health, source: str) -> None:
        """Take what a vehicle's service says of itself."""
        recorded = self._recorded.setdefault(vehicle_id, set())
        if health.recorded:
            recorded.add(source)
        else:
            recorded.discard(source)

    def is_recorded(self, vehicle_id: str) -> bool:
        """Whether a source of the vehicle has said that it plays a recording."""
        return bool(self._recorded.get(vehicle_id))

    def age_ns(self, vehicle_id: str, behind_ns: int, now_s: float) -> int:
        """Age of a message whose `t_ns` is so much before the host's time of its receipt.

        `now_s` is of the monotonic clock.
        """
        if behind_ns < LATE_NS:
            return max(behind_ns, 0)
        late_since_s = self._late_since_s.setdefault(vehicle_id, now_s)
        recorded = self._recorded.get(vehicle_id)
        unknown = recorded is None and now_s - late_since_s < UNKNOWN_S
        return 0 if unknown or recorded else behind_ns

    def forget(self, vehicle_id: str) -> None:
        """Drop what is known of a vehicle."""
        self._recorded.pop(vehicle_id, None)
        self._late_since_s.pop(vehicle_id, None)
