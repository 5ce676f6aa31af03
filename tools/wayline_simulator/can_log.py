"""Pure: a bus's frames as lines of a candump log."""

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from wayline_simulator.stream import Frames

Octets = NDArray[np.uint8]

BLOCK = 200_000
"""Lines that are made at once: some 30 MB of work space."""
HEX_DIGITS = np.frombuffer(b"0123456789ABCDEF", dtype=np.uint8)
MOST_BYTES = 8


def log_blocks(frames: Sequence[Frames], start_s: int, channel: str = "can0") -> Iterator[bytes]:
    """Lines `(seconds.microseconds) channel ID#DATA` in order of time, many at a time.

    `start_s` is the drive's start in Unix seconds. Frames of one instant keep the order of
    `frames`, as arbitration would if it is that of the ids.
    """
    if not frames:
        return
    times_us = np.concatenate([_microseconds(each.times_s) for each in frames])
    sources = np.repeat(np.arange(len(frames)), [len(each.times_s) for each in frames])
    rows = np.concatenate([np.arange(len(each.times_s)) for each in frames])
    order = np.argsort(times_us, kind="stable")
    for first in range(0, len(order), BLOCK):
        block = order[first : first + BLOCK]
        stamps = _stamps(times_us[block] + start_s * 1_000_000)
        bodies = _bodies(frames, sources[block], rows[block])
        yield _joined(stamps, f") {channel} ".encode(), bodies)


def _microseconds(times_s: NDArray[np.float64]) -> NDArray[np.int64]:
    return np.rint(times_s * 1e6).astype(np.int64)


def _stamps(unix_us: NDArray[np.int64]) -> Octets:
    """`(sssssssssss.uuuuuu` of shape (n, 18), for the seconds of 2001 to 2286."""
    digits = unix_us[:, None] // 10 ** np.arange(15, -1, -1) % 10 + ord("0")
    text = np.empty((len(unix_us), 18), dtype=np.uint8)
    text[:, 0], text[:, 11] = ord("("), ord(".")
    text[:, 1:11], text[:, 12:] = digits[:, :10], digits[:, 10:]
    return text


def _bodies(frames: Sequence[Frames], sources: NDArray[np.intp], rows: NDArray[np.intp]) -> Octets:
    """`ID#DATA` and the line's end, filled up with zero bytes."""
    heads = [f"{each.frame_id:0{8 if each.frame_id > 0x7FF else 3}X}#".encode() for each in frames]
    room = max(map(len, heads))
    text = np.zeros((len(rows), room + 2 * MOST_BYTES + 1), dtype=np.uint8)
    text[:, -1] = ord("\n")
    for source, (head, each) in enumerate(zip(heads, frames, strict=True)):
        mine = np.flatnonzero(sources == source)
        data = each.data[rows[mine]]
        body = np.zeros((len(mine), text.shape[1] - 1), dtype=np.uint8)
        body[:, : len(head)] = np.frombuffer(head, dtype=np.uint8)
        body[:, room : room + 2 * data.shape[1] : 2] = HEX_DIGITS[data >> 4]
        body[:, room + 1 : room + 2 * data.shape[1] : 2] = HEX_DIGITS[data & 15]
        text[mine, :-1] = body
    return text


def _joined(stamps: Octets, between: bytes, bodies: Octets) -> bytes:
    """Rows side by side without the filling."""
    middle = np.broadcast_to(np.frombuffer(between, dtype=np.uint8), (len(stamps), len(between)))
    lines = np.hstack([stamps, middle, bodies]).ravel()
    text: bytes = lines[lines != 0].tobytes()
    return text
