"""Pure: who is heard: vehicles that fall silent, and how many sources each has."""

from wayline.keys import Key

SOURCES_MAX = 16
"""Of one vehicle and topic; more are made up (SPEC section 2)."""
QUIET_S = 30.0
"""A source that is silent for so long gives its place to a new one."""


class Attendance:
    """When each vehicle was last heard, and from which sources; by the monotonic clock."""

    def __init__(self) -> None:
        self._heard_s: dict[str, float] = {}
        self._sources: dict[str, dict[str, dict[str, float]]] = {}
        """By vehicle and topic: when each source was heard, the newest last."""

    def admits(self, key: Key, now_s: float) -> bool:
        """Whether a source is one of its vehicle and topic, or there is room for it."""
        sources = self._sources.setdefault(key.vehicle_id, {}).setdefault(key.topic, {})
        if sources.pop(key.source, None) is None and len(sources) >= SOURCES_MAX:
            quietest = next(iter(sources))
            if now_s - sources[quietest] < QUIET_S:
                return False
            del sources[quietest]
        sources[key.source] = now_s
        return True

    def hear(self, vehicle_id: str, now_s: float) -> None:
        """Note a vehicle's message; `now_s` is of the monotonic clock."""
        self._heard_s[vehicle_id] = now_s

    def silent(self, since_s: float) -> list[str]:
        """Vehicles not heard since an instant."""
        return [name for name, heard_s in self._heard_s.items() if heard_s < since_s]

    def leave(self, since_s: float) -> list[str]:
        """Vehicles not heard since an instant; they are forgotten."""
        names = self.silent(since_s)
        for name in names:
            del self._heard_s[name]
            self._sources.pop(name, None)
        return names
