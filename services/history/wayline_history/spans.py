"""Pure: events that last: open, going on, over."""

from typing import NamedTuple

from msgspec.structs import replace

from wayline_history.records import Event, EventKind

REST_NS = 60_000_000_000
"""What repeats within this time is one event."""


class Place(NamedTuple):
    """Where the vehicle was last known to be."""

    lat_deg: float | None = None
    lon_deg: float | None = None


class Spans:
    """The events of a vehicle that may still go on, and those that changed since last asked."""

    def __init__(self) -> None:
        self._open: dict[tuple[EventKind, str], Event] = {}
        self._changed: dict[tuple[int, EventKind, str], Event] = {}

    def tell(self, event: Event) -> None:
        """An event that is over as it is told."""
        self._changed[event.t_ns, event.kind, event.name] = event

    def begin(self, kind: EventKind, name: str, t_ns: int, place: Place) -> None:
        """Something begins, unless it goes on already."""
        if (kind, name) not in self._open:
            event = Event(
                t_ns=t_ns, kind=kind, name=name, lat_deg=place.lat_deg, lon_deg=place.lon_deg
            )
            self._open[kind, name] = event
            self.tell(event)

    def end(self, kind: EventKind, name: str, t_ns: int) -> None:
        """Something is over, if it was going on."""
        event = self._open.pop((kind, name), None)
        if event is not None:
            self.tell(replace(event, until_ns=max(t_ns, event.t_ns)))

    def end_all(self, kind: EventKind, t_ns: int) -> None:
        """Whatever of a kind goes on is over."""
        for open_kind, name in list(self._open):
            if open_kind == kind:
                self.end(kind, name, t_ns)

    def count(self, kind: EventKind, name: str, t_ns: int) -> None:
        """Something happened once more; one that has not for a minute begins anew."""
        event = self._open.get((kind, name))
        if event is not None and not _rests(event, t_ns):
            later_ns = max(event.until_ns or event.t_ns, t_ns)
            event = replace(event, count=(event.count or 0) + 1, until_ns=later_ns)
        else:
            event = Event(t_ns=t_ns, kind=kind, name=name, until_ns=t_ns, count=1)
        self._open[kind, name] = event
        self.tell(event)

    def take(self) -> tuple[Event, ...]:
        """What is new or has changed since the last time, in order of beginning."""
        changed, self._changed = self._changed, {}
        return tuple(changed[key] for key in sorted(changed))

    def __bool__(self) -> bool:
        return bool(self._changed)


def _rests(event: Event, t_ns: int) -> bool:
    newest_ns = event.until_ns or event.t_ns
    return not -REST_NS <= t_ns - newest_ns <= REST_NS
