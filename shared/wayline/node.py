"""Runs one core: ticks on its grid, its records to its store, the store's answers back."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

import msgspec

from wayline.core import Core, Record, Store
from wayline.grid import TickGrid
from wayline.inputs import Flush
from wayline.messages import Message


@dataclass(slots=True)
class Node:
    """A core with its name on the bus and its store.

    Live services and replay both run their cores through this, so they behave the same.
    """

    name: str
    core: Core
    store: Store | None = None
    _grid: TickGrid | None = field(init=False, default=None)

    def __post_init__(self) -> None:
        if self.core.period_ns is not None:
            self._grid = TickGrid(self.core.period_ns)

    def take(self, message: Message, source: str) -> Iterator[Message]:
        """Give a bus message to the core, with the ticks that it makes due."""
        if self._grid is None:
            yield from self.give(message, source)
            return
        for tick in self._grid.before(message.t_ns):
            yield from self.give(tick, source)
        yield from self.give(message, source)
        for tick in self._grid.at(message.t_ns):
            yield from self.give(tick, source)

    def advance(self, t_ns: int) -> Iterator[Message]:
        """Let time pass without a message."""
        if self._grid is not None:
            for tick in self._grid.before(t_ns):
                yield from self.give(tick, self.name)

    def finish(self, t_ns: int) -> Iterator[Message]:
        """Tell the core that input has ended."""
        yield from self.give(Flush(t_ns), self.name)

    def give(self, message: msgspec.Struct, source: str) -> Iterator[Message]:
        """Give any input to the core and yield what it puts on the bus."""
        outputs: Sequence[Message | Record] = self.core.handle(message, source)
        for output in outputs:
            if isinstance(output, Message):
                yield output
            elif self.store is not None:
                for answer in self.store.save(output):
                    yield from self.give(answer, self.name)
