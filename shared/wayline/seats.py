"""Pure: the cores at work, one a vehicle (and source of raw input), and when each needs time."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

from wayline.inputs import Tick
from wayline.messages import Message
from wayline.node import Node

IDLE_S = 1.0
"""Without input this long, time is advanced by the monotonic clock (SPEC section 2)."""

MakeNode = Callable[[str, str], Node]
"""A core with its store for a vehicle (and, for raw input, a source)."""


@dataclass(slots=True)
class Seat:
    """One core at work, and how far its time has come."""

    vehicle_id: str
    source: str
    """Of raw input; empty for a core that reads the bus."""
    node: Node
    last_ns: int = 0
    heard_s: float = 0.0

    def hear(self, t_ns: int, now_s: float) -> None:
        """Note that a message has come; `now_s` is of the monotonic clock."""
        self.last_ns, self.heard_s = max(self.last_ns, t_ns), now_s

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

    def leave(self, vehicle_id: str) -> list[Seat]:
        """The seats of a vehicle, which are no longer kept."""
        names = [name for name in self._seats if name[0] == vehicle_id]
        return [self._seats.pop(name) for name in names]
