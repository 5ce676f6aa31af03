"""Pure: the cores at work, one a vehicle (and source of raw input), and when each needs time."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import NamedTuple

from wayline.inputs import Tick
from wayline.messages import Message
from wayline.node import Node

IDLE_S = 1.0
"""Without input this long, time is advanced by the monotonic clock (SPEC section 2)."""

BACK_NS = 3_000_000_000
"""Before the newest by more, a message is not late but of another time."""
BACK_FOR_S = 2.0
BACK_MESSAGES = 3
"""So long and so often nothing but older times: the newest ones were wrong."""

MakeNode = Callable[[str, str], Node]
"""A core with its store for a vehicle (and, for raw input, a source)."""


class Back(NamedTuple):
    """Messages that are all older than the newest one was."""

    first_ns: int
    since_s: float
    """By the monotonic clock."""
    messages: int = 1
    newest_ns: int = 0


@dataclass(slots=True)
class Seat:
    """One core at work, and how far its time has come."""

    vehicle_id: str
    source: str
    """Of raw input; empty for a core that reads the bus."""
    node: Node
    last_ns: int = 0
    heard_s: float = 0.0
    _timed_ns: int = 0
    """Of messages that make ticks due; `last_ns` is of all."""
    _back: Back | None = None

    def hear(self, t_ns: int, now_s: float, *, timeless: bool = False) -> None:
        """Note that a message has come; `now_s` is of the monotonic clock.

        Of `timeless` ones (see `Node`) another service makes what makes ticks due. One that is
        busy lags behind: that takes no time back.
        """
        self.heard_s = now_s
        lags = not timeless and t_ns > self._timed_ns - BACK_NS
        if not timeless:
            self._timed_ns = max(self._timed_ns, t_ns)
        if t_ns > self.last_ns - BACK_NS:
            self.last_ns, self._back = max(self.last_ns, t_ns), None
        elif lags:
            return
        elif self._back is None:
            self._back = Back(t_ns, now_s)
        else:
            self._back = self._back._replace(messages=self._back.messages + 1, newest_ns=t_ns)

    @property
    def is_back(self) -> bool:
        """Whether time has gone back for good: nothing but older times come, and they go on.

        Whoever sees it gives the seat to a new core, as this one waits for what was wrong.
        """
        back = self._back
        if back is None or back.messages < BACK_MESSAGES:
            return False
        return self.heard_s - back.since_s >= BACK_FOR_S and back.newest_ns > back.first_ns

    def is_due(self, now_s: float) -> bool:
        """Whether time alone may change something."""
        wakes_ns = self.node.wakes_ns
        if wakes_ns is None:
            return False
        silent_s = now_s - self.heard_s
        return silent_s >= IDLE_S and self.last_ns + round(silent_s * 1e9) >= wakes_ns

    def pass_time(self, now_s: float) -> Iterator[Message]:
        """Let time go on to now, as the monotonic clock has it."""
        t_ns = self.last_ns + round((now_s - self.heard_s) * 1e9)
        return self.node.give(Tick(t_ns), self.source) if self.source else self.node.advance(t_ns)

    def finish(self) -> Iterator[Message]:
        """Tell the core that input has ended, so that nothing learned is lost."""
        return self.node.finish(self.last_ns)


class Seats:
    """Every seat of a service, made when its vehicle is first heard."""

    def __init__(self, make_node: MakeNode) -> None:
        self._make_node = make_node
        self._seats: dict[tuple[str, str], Seat] = {}

    def __iter__(self) -> Iterator[Seat]:
        return iter(self._seats.values())

    def of(self, vehicle_id: str, source: str = "") -> Seat:
        """The seat of a vehicle (and source)."""
        seat = self._seats.get((vehicle_id, source))
        if seat is None:
            seat = Seat(vehicle_id, source, self._make_node(vehicle_id, source))
            self._seats[vehicle_id, source] = seat
        return seat

    def renew(self, seat: Seat) -> Seat:
        """The same seat with a new core, which knows what the store does."""
        del self._seats[seat.vehicle_id, seat.source]
        return self.of(seat.vehicle_id, seat.source)

    def leave(self, vehicle_id: str) -> list[Seat]:
        """The seats of a vehicle, which are no longer kept."""
        names = [name for name in self._seats if name[0] == vehicle_id]
        return [self._seats.pop(name) for name in names]
