"""Pure: applies events at their own time, even when they arrive late, by rewinding."""

from collections import deque
from collections.abc import Callable
from typing import Generic, Protocol, TypeVar

State = TypeVar("State")


class Event(Protocol):
    """Something that happened to the vehicle at an instant."""

    @property
    def t_ns(self) -> int:
        """When it happened."""
        ...


EventType = TypeVar("EventType", bound=Event)


class Timeline(Generic[EventType, State]):
    """Keeps the events of the last second with the state before each.

    `apply` brings the state forward to an event and takes the event in.
    """

    def __init__(
        self,
        apply: Callable[[EventType], None],
        snapshot: Callable[[], State],
        restore: Callable[[State], None],
        depth_ns: int,
    ) -> None:
        self._apply, self._snapshot, self._restore = apply, snapshot, restore
        self._depth_ns = depth_ns
        self._entries: deque[tuple[EventType, State]] = deque()
        """Events, each with the state just before it."""
        self._now_ns: int | None = None

    def add(self, event: EventType) -> bool:
        """Apply an event at its own time; False when it is older than the history reaches."""
        t_ns, now_ns = event.t_ns, self._now_ns
        if now_ns is None or t_ns >= now_ns:
            self._push(event)
            self._now_ns = t_ns
            self._forget(t_ns - self._depth_ns)
            return True
        if t_ns < now_ns - self._depth_ns:
            return False
        later = self._rewind_to(t_ns)
        self._push(event)
        for each in reversed(later):
            self._push(each)
        return True

    def _forget(self, before_ns: int) -> None:
        entries = self._entries
        while entries[0][0].t_ns < before_ns:
            entries.popleft()

    def _rewind_to(self, t_ns: int) -> list[EventType]:
        undone: list[tuple[EventType, State]] = []
        while self._entries and self._entries[-1][0].t_ns > t_ns:
            undone.append(self._entries.pop())
        if undone:
            self._restore(undone[-1][1])
        return [event for event, _ in undone]

    def _push(self, event: EventType) -> None:
        self._entries.append((event, self._snapshot()))
        self._apply(event)
