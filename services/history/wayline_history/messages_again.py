"""Pure: rows as the messages that they were, as far as they were kept."""

from collections.abc import Iterator
from typing import Any

from wayline.messages import GpsFix, Message, Pose, Progress
from wayline_history.chunk import Chunk
from wayline_history.layouts import ENGINE, SOURCE, US, Kind
from wayline_history.points import shown

WAS: dict[Kind, tuple[type[Message], str]] = {
    "raw": (GpsFix, "gps-ingest"),
    "fused": (Pose, "fusion"),
    "on_route": (Progress, "eta"),
}
"""What a row was, and who published it where that was not kept."""
BESIDE = frozenset({ENGINE, SOURCE})
"""Columns that are no fields of the message."""


def messages_of(chunk: Chunk) -> Iterator[tuple[str, Message]]:
    """The messages of a chunk's rows in order of time, each with its source on the bus.

    What was not kept of them is unknown, or as it is by default.
    """
    message, published_by = WAS[chunk.layout.kind]
    names = [column.name for column in chunk.layout.columns[1:] if column.name not in BESIDE]
    columns = [shown(chunk, name) for name in names]
    is_fix = message is GpsFix
    sources = shown(chunk, SOURCE) if is_fix else [published_by] * len(chunk)
    known: dict[str, Any] = {"valid": True} if is_fix else {}
    for t_us, source, *values in zip(chunk.times_us.tolist(), sources, *columns, strict=True):
        yield source, message(t_ns=t_us * US, **known, **dict(zip(names, values, strict=True)))
