"""Pure: a vehicle's services, as many as it can have: what is made up beyond them is not shown."""

from dataclasses import dataclass

from wayline.attendance import SOURCES_MAX
from wayline.messages import Health
from wayline_dashboard.sections import service_view
from wayline_dashboard.view import ServiceView


@dataclass(slots=True)
class Entry:
    """What is known of a service."""

    is_up: bool | None = None
    """By its liveliness token; None where none was seen (a replay, say)."""
    health: Health | None = None


class Roll:
    """Services by name, the one heard last at the end.

    Where there is no room a newcomer takes the place of the one that was silent for longest and
    has no token; one that is up keeps its place.
    """

    def __init__(self) -> None:
        self._entries: dict[str, Entry] = {}

    def hear(self, health: Health) -> bool:
        """Take a service's health; False where there is no room for it."""
        entry = self._entry(health.service)
        if entry is None:
            return False
        entry.health = health
        return True

    def note(self, service: str, *, is_up: bool) -> bool:
        """Take a service's token that came or went; False where there is no room for it."""
        entry = self._entry(service)
        if entry is None:
            return False
        entry.is_up = is_up
        return True

    def views(self) -> tuple[ServiceView, ...]:
        """Every service by name. A health without a token seen speaks of a living service."""
        return tuple(
            service_view(name, entry.is_up is not False, entry.health)
            for name, entry in sorted(self._entries.items())
        )

    def _entry(self, name: str) -> Entry | None:
        entry = self._entries.pop(name, None)
        if entry is None:
            if len(self._entries) >= SOURCES_MAX and not self._make_room():
                return None
            entry = Entry()
        self._entries[name] = entry
        return entry

    def _make_room(self) -> bool:
        quietest = next((name for name, each in self._entries.items() if not each.is_up), None)
        if quietest is None:
            return False
        del self._entries[quietest]
        return True
