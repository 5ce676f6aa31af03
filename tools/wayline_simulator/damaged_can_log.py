"""Pure: a bus's frames as a candump log that suffered; slower than `can_log`, frame by frame."""

import heapq
from collections.abc import Iterator, Sequence

import numpy as np

from wayline_simulator.damage import Damage, Frame, damaged_frames
from wayline_simulator.stream import Frames


def damaged_log(
    frames: Sequence[Frames],
    start_s: int,
    damage: Damage,
    random: np.random.Generator,
    channel: str = "can0",
) -> Iterator[bytes]:
    """Lines `(seconds.microseconds) channel ID#DATA` in order of time, after the damage."""
    in_order = heapq.merge(*(_frames(each) for each in frames), key=lambda frame: frame[0])
    for time_s, frame_id, data in damaged_frames(in_order, damage, random):
        unix_us = start_s * 1_000_000 + round(time_s * 1e6)
        seconds, micros = divmod(unix_us, 1_000_000)
        digits = 8 if frame_id > 0x7FF else 3
        line = f"({seconds:010d}.{micros:06d}) {channel} {frame_id:0{digits}X}#{data.hex().upper()}"
        yield f"{line}\n".encode()


def _frames(frames: Frames) -> Iterator[Frame]:
    for time_s, data in zip(frames.times_s.tolist(), frames.data, strict=True):
        yield time_s, frames.frame_id, data.tobytes()
