"""Pure: rows of one kind as a few bytes, and back.

Columns are kept as differences, smooth ones as differences of those; of the numbers that follow
first all lowest bytes stand, then all next ones, where nearly all are zero; zlib does the rest.
"""

import struct
import zlib
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import msgspec
import numpy as np
from numpy.typing import NDArray

from wayline_history.layouts import NULL, Layout

Values = NDArray[np.int64]
VERSION = 1
_HEAD = struct.Struct("<BIH")
"""Version, rows, bytes of the texts."""
LEVEL = 6


@dataclass(frozen=True, slots=True, eq=False)
class Chunk:
    """Rows in order of time."""

    layout: Layout
    values: Values
    """(rows, columns), in the columns' steps, `NULL` where unknown; times in microseconds."""
    texts: tuple[str, ...] = ()
    """What numbers in text columns stand for."""

    def __len__(self) -> int:
        return len(self.values)

    @property
    def times_us(self) -> Values:
        """When each row was, microseconds since 1970."""
        times: Values = self.values[:, 0]
        return times

    def column(self, name: str) -> Values:
        """One quantity in its steps."""
        found: Values = self.values[:, self.layout.place(name)]
        return found

    def taken(self, rows: NDArray[np.generic] | slice) -> "Chunk":
        """Some of the rows, by a mask, indices or a slice."""
        return replace(self, values=self.values[rows])

    def between(self, from_us: int, to_us: int) -> "Chunk":
        """The rows from an instant on and before another."""
        first, last = np.searchsorted(self.times_us, (from_us, to_us))
        return self.taken(slice(int(first), int(last)))


def chunk_of(layout: Layout, rows: Sequence[tuple[int, ...]], texts: Iterable[str] = ()) -> Chunk:
    """Rows in any order as a chunk."""
    values = np.array(rows, np.int64).reshape(-1, len(layout.columns))
    return merged(layout, [Chunk(layout, values, tuple(texts))])


def merged(layout: Layout, chunks: Sequence[Chunk]) -> Chunk:
    """Several chunks as one: in order of time, what came twice once; of two the later one stands.

    Rows are the same where the time is, and what else tells rows of one instant apart.
    """
    texts: dict[str, int] = {}
    values = np.concatenate([_renumbered(chunk, texts) for chunk in chunks])
    apart = [place for place, column in enumerate(layout.columns) if column.is_apart]
    values = values[np.lexsort([values[:, place] for place in (*apart, 0)])]
    keys = values[:, [0, *apart]]
    is_last = np.append(np.any(keys[1:] != keys[:-1], axis=1), [True] * bool(len(keys)))
    return Chunk(layout, values[is_last.astype(bool)], tuple(texts))


def _renumbered(chunk: Chunk, texts: dict[str, int]) -> Values:
    """Its values with the numbers of texts as `texts` has them, which gets the new ones."""
    numbers = np.array([texts.setdefault(text, len(texts)) for text in chunk.texts], np.int64)
    values = chunk.values
    if list(numbers) == list(range(len(numbers))):
        return values
    values = values.copy()
    for place, column in enumerate(chunk.layout.columns):
        if column.is_text:
            known = values[:, place] != NULL
            values[known, place] = numbers[values[known, place]]
    return values


def encoded(chunk: Chunk) -> bytes:
    """The bytes that `decoded` reads."""
    values = chunk.values
    unknown = values == NULL
    steps = np.where(unknown, 0, values)
    changes = np.diff(steps, axis=0, prepend=0)
    for place in _smooth(chunk.layout):
        changes[1:, place] = np.diff(changes[1:, place], prepend=0)
    zigzag = (changes << 1) ^ (changes >> 63)
    planes = np.ascontiguousarray(zigzag.T, "<u8").view(np.uint8).reshape(-1, 8).T.tobytes()
    flags = np.packbits(unknown.T).tobytes() if unknown.any() else b""
    texts = msgspec.json.encode(chunk.texts) if chunk.texts else b""
    head = _HEAD.pack(VERSION, len(values), len(texts))
    return head + zlib.compress(texts + planes + flags, LEVEL)


def decoded(layout: Layout, data: bytes) -> Chunk:
    """The chunk of bytes that `encoded` made. Raises ValueError for others."""
    version, rows, text_bytes = _HEAD.unpack_from(data)
    if version != VERSION:
        raise ValueError(f"history of version {version}, which is not known")
    body = zlib.decompress(data[_HEAD.size :])
    texts = tuple(msgspec.json.decode(body[:text_bytes], type=list[str])) if text_bytes else ()
    width = len(layout.columns)
    ends = text_bytes + 8 * rows * width
    planes = np.frombuffer(body, np.uint8, 8 * rows * width, text_bytes)
    zigzag = np.ascontiguousarray(planes.reshape(8, -1).T).view("<u8").reshape(width, rows).T
    changes = (zigzag >> np.uint64(1)).view(np.int64) ^ -(zigzag & np.uint64(1)).view(np.int64)
    for place in _smooth(layout):
        changes[1:, place] = np.cumsum(changes[1:, place])
    values = np.cumsum(changes, axis=0)
    if len(body) > ends:
        flags = np.unpackbits(np.frombuffer(body, np.uint8, offset=ends), count=rows * width)
        values[flags.reshape(width, rows).T.astype(bool)] = NULL
    return Chunk(layout, values, texts)


def _smooth(layout: Layout) -> list[int]:
    return [place for place, column in enumerate(layout.columns) if column.is_smooth]
