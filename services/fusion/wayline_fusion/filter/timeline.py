"""Pure: applies events at their own time, even when they arrive late, by rewinding."""

from collections import deque
from collections.abc import Sequence
from typing import Any, Generic, Protocol, TypeVar


class Timed(Protocol):
    """Something that happened to the vehicle at an instant."""

    @property
    def t_ns(self) -> int:
        """When it happened."""
        ...


EventType = TypeVar("EventType", bound=Timed)
Taken_contra = TypeVar("Taken_contra", contravariant=True)


class Rewindable(Protocol[Taken_contra]):
    """A state that events bring forward, and that can be set back."""

    @property
    def takes(self) -> frozenset[type]:
        """The kinds of events that it wants to be given."""
        ...

    def apply(self, event: Taken_contra) -> None:
        """Bring the state forward to an event and take it in."""
        ...

    def snapshot(self) -> Any:
        """Everything that `restore` needs to set the state back to now; never changed later."""
        ...

    def restore(self, snapshot: Any) -> None:
        """Set the state back."""
        ...


class Timeline(Generic[EventType]):
    """Keeps the events of the last second with the states before each.

    Of several states each is given the events that it takes, in the order of `states`: one that
    reads another comes after it.
    """

    def __init__(self, states: Sequence[Rewindable[EventType]], depth_ns: int) -> None:
        self._states, self._depth_ns = tuple(states), depth_ns
        self._takers: dict[type, tuple[Rewindable[EventType], ...]] = {}
        self._entries: deque[tuple[EventType, tuple[Any, ...]]] = deque()
        """Events, each with the states just before it."""
        self._now_ns: int | None = None

    def add(self, *events: EventType) -> bool:
        """Apply events of one instant at their own time; False of those before the history."""
        t_ns, now_ns = events[0].t_ns, self._now_ns
        if now_ns is None or t_ns >= now_ns:
            for event in events:
                self._push(event)
            self._now_ns = t_ns
            self._forget(t_ns - self._depth_ns)
            return True
        if t_ns < now_ns - self._depth_ns:
            return False
        later = self._rewind_to(t_ns)
        for event in events:
            self._push(event)
        for each in reversed(later):
            self._push(each)
        return True

    def _forget(self, before_ns: int) -> None:
        entries = self._entries
        while entries[0][0].t_ns < before_ns:
            entries.popleft()

    def _rewind_to(self, t_ns: int) -> list[EventType]:
        undone: list[tuple[EventType, tuple[Any, ...]]] = []
        while self._entries and self._entries[-1][0].t_ns > t_ns:
            undone.append(self._entries.pop())
        if undone:
            for state, snapshot in zip(self._states, undone[-1][1], strict=True):
                state.restore(snapshot)
        return [event for event, _ in undone]

    def _push(self, event: EventType) -> None:
        self._entries.append((event, tuple([state.snapshot() for state in self._states])))
        kind = type(event)
        takers = self._takers.get(kind)
        if takers is None:
            takers = tuple(state for state in self._states if kind in state.takes)
            self._takers[kind] = takers
        for state in takers:
            state.apply(event)
