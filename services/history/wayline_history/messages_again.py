"""Pure: rows as the messages that they were, as far as they were kept."""

from collections.abc import Iterator

from wayline.messages import Message, Pose, Progress
from wayline_history.chunk import Chunk
from wayline_history.layouts import ENGINE, FIXES, SOURCE, US, Kind
from wayline_history.points import shown
from wayline_history.samples import fix_of

WAS: dict[Kind, tuple[type[Message], str]] = {
    "fused": (Pose, "fusion"),
    "on_route": (Progress, "eta"),
}
"""What a row was, and who published it: of fixes that was kept."""
BESIDE = frozenset({ENGINE})
"""Columns that are no fields of the message."""


def messages_of(chunk: Chunk) -> Iterator[tuple[str, Message]]:
    """The messages of a chunk's rows in order of time, each with its source on the bus.

    What was not kept of them is unknown, or as it is by default.
    """
    if chunk.layout is FIXES:
        sources = shown(chunk, SOURCE)
        yield from zip(sources, map(fix_of, chunk.values.tolist()), strict=True)
        return
    message, published_by = WAS[chunk.layout.kind]
    names = [column.name for column in chunk.layout.columns[1:] if column.name not in BESIDE]
    columns = [shown(chunk, name) for name in names]
    for t_us, *values in zip(chunk.times_us.tolist(), *columns, strict=True):
        yield published_by, message(t_ns=t_us * US, **dict(zip(names, values, strict=True)))
