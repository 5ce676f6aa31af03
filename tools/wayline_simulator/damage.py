"""Pure: what cables, buffers and loggers do to sentences and frames."""

import heapq
from collections.abc import Iterable, Iterator
from typing import Annotated, NamedTuple

import numpy as np
from msgspec import Meta

from wayline.strict import Strict
from wayline_simulator.stream import TimedLine

Share = Annotated[float, Meta(ge=0.0, le=1.0)]
NotNegative = Annotated[float, Meta(ge=0.0)]

LINE_ENDS = b"\r\n"
NOISE_BYTES_MAX = 40
FRAME_BYTES_MAX = 8
SHORTEST_TEAR = 1

Frame = tuple[float, int, bytes]
"""Arrival, CAN id, data."""


class Damage(Strict, frozen=True, kw_only=True):
    """`[damage]` of a scenario: shares of all sentences, and of all frames; 0 is an intact link.

    The faults are those of nmea/regensburg-geko (torn and glued lines) and of gpsd's recordings
    (binary noise); how often they happen is the scenario's choice.
    """

    sentences_flipped: Share = 0.0
    """One bit of one byte is another."""
    sentences_torn: Share = 0.0
    """The rest is missing."""
    sentences_glued: Share = 0.0
    """The line's end is missing: the next sentence follows in the same line."""
    sentences_repeated: Share = 0.0
    sentences_late: Share = 0.0
    """Held up by `late_s`, so that later ones overtake it."""
    noise_between: Share = 0.0
    """Binary bytes stand in a line of their own after a sentence."""
    late_s: NotNegative = 1.5
    frames_lost: Share = 0.0
    frames_short: Share = 0.0
    """Share of frames with fewer bytes than they should have."""
    frames_long: Share = 0.0
    """Share of frames with more bytes than they should have, where there is room."""
    frames_repeated: Share = 0.0

    @property
    def harms_frames(self) -> bool:
        """Whether any frame may be touched."""
        return (
            max(self.frames_lost, self.frames_short, self.frames_long, self.frames_repeated) > 0.0
        )


class Held(NamedTuple):
    """A line that waits for its turn."""

    arrival_s: float
    order: int
    line: TimedLine


def damaged_lines(
    lines: Iterable[TimedLine], damage: Damage, random: np.random.Generator
) -> Iterator[TimedLine]:
    """The lines as they reach the log, in order of arrival again."""
    waiting: list[Held] = []
    order = 0
    for line in _glued(_harmed(lines, damage, random), damage, random):
        while waiting and waiting[0].arrival_s <= line.arrival_s:
            yield heapq.heappop(waiting).line
        if random.random() < damage.sentences_late:
            late = line._replace(arrival_s=line.arrival_s + damage.late_s)
            heapq.heappush(waiting, Held(late.arrival_s, order, late))
            order += 1
        else:
            yield line
    while waiting:
        yield heapq.heappop(waiting).line


def damaged_frames(
    frames: Iterable[Frame], damage: Damage, random: np.random.Generator
) -> Iterator[Frame]:
    """The frames as they reach the log."""
    for arrival_s, frame_id, data in frames:
        lost, short, long, repeated = random.random(4)
        if lost < damage.frames_lost:
            continue
        harmed = data
        if short < damage.frames_short:
            harmed = data[: int(random.integers(len(data)))] if data else data
        elif long < damage.frames_long:
            harmed = data + random.bytes(max(FRAME_BYTES_MAX - len(data), 0))
        yield arrival_s, frame_id, harmed
        if repeated < damage.frames_repeated:
            yield arrival_s, frame_id, harmed


def _harmed(
    lines: Iterable[TimedLine], damage: Damage, random: np.random.Generator
) -> Iterator[TimedLine]:
    for line in lines:
        flipped, torn, repeated, noise = random.random(4)
        text = line.text
        if flipped < damage.sentences_flipped:
            text = _flipped(text, random)
        if torn < damage.sentences_torn:
            text = text[: int(random.integers(SHORTEST_TEAR, max(len(text), 2)))]
        yield line._replace(text=text)
        if repeated < damage.sentences_repeated:
            yield line._replace(text=text)
        if noise < damage.noise_between:
            yield line._replace(text=_noise(random))


def _flipped(text: bytes, random: np.random.Generator) -> bytes:
    """One bit other than before; never a line's end, which would tear it as well."""
    place = int(random.integers(len(text)))
    bits = [bit for bit in range(8) if text[place] ^ (1 << bit) not in LINE_ENDS]
    harmed = text[place] ^ (1 << int(random.choice(bits)))
    return text[:place] + bytes((harmed,)) + text[place + 1 :]


def _noise(random: np.random.Generator) -> bytes:
    """What a receiver's binary protocol looks like to a reader of text."""
    raw = random.bytes(int(random.integers(1, NOISE_BYTES_MAX + 1)))
    return bytes(byte for byte in raw if byte not in LINE_ENDS) or b"\x00"


def _glued(
    lines: Iterable[TimedLine], damage: Damage, random: np.random.Generator
) -> Iterator[TimedLine]:
    before: TimedLine | None = None
    for line in lines:
        joined = line if before is None else before._replace(text=before.text + line.text)
        before = joined if random.random() < damage.sentences_glued else None
        if before is None:
            yield joined
    if before is not None:
        yield before
