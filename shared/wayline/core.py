"""Pure: the shapes that every service's core and store have, so that one loop can run them all.

A core gets inputs (bus messages, raw input, ticks) and returns outputs: messages for the bus,
records for its own store, and `Sleep` where it wants no ticks for a while. It does no I/O and
reads no clock. What a store answers (a road's profile after a merge, say) goes back into the same
core as an input.
"""

from collections.abc import Mapping, Sequence
from typing import ClassVar, Protocol, runtime_checkable

import msgspec

from wayline.messages import Message


class Record(msgspec.Struct, frozen=True, kw_only=True):
    """Something a core wants kept; its store knows how."""


class Sleep(msgspec.Struct, frozen=True):
    """No tick changes anything until then, unless a message comes; None: until one comes."""

    until_ns: int | None = None


class Core(Protocol):
    """One vehicle's estimator or translator."""

    reads: ClassVar[frozenset[type[Message]]]
    """Topics of the bus that it wants."""
    period_ns: ClassVar[int | None]
    """Spacing of the ticks that it wants; None for none."""

    def handle(self, message: msgspec.Struct, source: str) -> Sequence[Message | Record | Sleep]:
        """Take one input from a source and return what follows from it, in order."""
        ...


class Store(Protocol):
    """Keeps a core's records; answers with what the core should know from now on."""

    def save(self, record: Record) -> Sequence[msgspec.Struct]:
        """Keep a record durably before returning."""
        ...


@runtime_checkable
class Choosy(Store, Protocol):
    """A store that leaves out some of what it is given."""

    @property
    def left_out(self) -> Mapping[str, int]:
        """How often, by reason."""
        ...
