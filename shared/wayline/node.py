"""Pure: runs one core: ticks on its grid, its records to its store, the store's answers back."""

from collections.abc import Iterator
from dataclasses import dataclass, field

import msgspec

from wayline.core import Core, Sleep, Store
from wayline.grid import TickGrid
from wayline.inputs import Flush, Tick
from wayline.messages import Message


@dataclass(slots=True)
class Node:
    """A core with its name on the bus and its store.

    Live services and replay both run their cores through this, so they behave the same.
    """

    name: str
    core: Core
    store: Store | None = None
    timeless: frozenset[type[Message]] = frozenset()
    """Messages that make no tick due: what another core makes of them is still to come."""
    wakes_ns: int | None = field(init=False, default=0)
    """Time before this changes nothing while no message comes; None: no time does."""
    age_ns: int = field(init=False, default=0)
    """Of the newest message when it came."""
    _grid: TickGrid | None = field(init=False, default=None)

    def __post_init__(self) -> None:
        if self.core.period_ns is not None:
            self._grid = TickGrid(self.core.period_ns)

    def take(self, message: Message, source: str, age_ns: int = 0) -> Iterator[Message]:
        """Give a bus message to the core, with the ticks that it makes due.

        `age_ns` is how old the message was when it came, by the host's clock.
        """
        if type(message) in self.timeless:
            self.wakes_ns = 0  # what it waits for may never come
            yield from self.give(message, source)
            return
        if self._grid is not None:
            yield from self._ticked(self._grid.before(message.t_ns))
        self.wakes_ns, self.age_ns = 0, age_ns
        yield from self.give(message, source)
        if self._grid is not None:
            yield from self._ticked(self._grid.at(message.t_ns))

    def advance(self, t_ns: int) -> Iterator[Message]:
        """Let time pass without a message."""
        if self._grid is not None and self.wakes_ns is not None and t_ns >= self.wakes_ns:
            yield from self._ticked(self._grid.before(t_ns))

    def finish(self, t_ns: int) -> Iterator[Message]:
        """Tell the core that input has ended."""
        yield from self.give(Flush(t_ns), self.name)

    def give(self, message: msgspec.Struct, source: str) -> Iterator[Message]:
        """Give any input to the core and yield what it puts on the bus."""
        for output in self.core.handle(message, source):
            match output:
                case Message():
                    yield output
                case Sleep():
                    self.wakes_ns = output.until_ns
                case _ if self.store is not None:
                    for answer in self.store.save(output):
                        yield from self.give(answer, self.name)

    def _ticked(self, ticks: Iterator[Tick]) -> Iterator[Message]:
        for tick in ticks:
            aged = Tick(tick.t_ns, self.age_ns) if self.age_ns else tick
            yield from self.give(aged, self.name)
