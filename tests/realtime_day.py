"""A simulated network's day as its GTFS-Realtime feeds were told, one message a while, in files."""

import heapq
import os
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

from wayline.messages import Arrivals, GpsFix, Message, Pose, Progress, StopEvent
from wayline.view import Receipt
from wayline_eta.board import EtaBoard
from wayline_eta.realtime_feeds import positions_feed, updates_feed
from wayline_evaluation.replays import read_topic
from wayline_replay.replay import replay

SECOND_NS = 1_000_000_000
SHOWN: tuple[type[Message], ...] = (Pose, GpsFix, Progress, Arrivals, StopEvent)


class Told(NamedTuple):
    """A message of a vehicle."""

    t_ns: int
    vehicle_id: str
    source: str
    number: int
    message: Message


class Clock:
    """Of the vehicles, the host and its readers alike."""

    def __init__(self) -> None:
        self.now_ns = 0

    def __call__(self) -> int:
        return self.now_ns


def replayed(folder: Path, feed: Path, out: Path) -> list[Told]:
    """What a bus told on its day, in order of time."""
    vehicle_id = replay(folder, out, feed_paths=[feed]).vehicle_id
    topics = [read_topic(out, kind) for kind in SHOWN]
    told = [
        Told(
            message.t_ns,
            vehicle_id,
            "gps-ingest" if isinstance(message, GpsFix) else "",
            number,
            message,
        )
        for messages in topics
        for number, message in enumerate(messages)
    ]
    return sorted(told, key=lambda each: each.t_ns)


def write_feeds(buses: Sequence[Sequence[Told]], out: Path, *, every_s: int) -> int:
    """Write what both feeds say every so often; how many messages that was.

    `out` gets one file a message, of both feeds' entities, so that a validator can compare them;
    its modification time is when it was asked for.
    """
    out.mkdir()
    clock = Clock()
    board = EtaBoard(clock)
    feeds = positions_feed(board, clock), updates_feed(board, clock)
    next_s = count = 0
    for told in heapq.merge(*buses, key=lambda each: each.t_ns):
        while next_s and told.t_ns > next_s * SECOND_NS:
            clock.now_ns = next_s * SECOND_NS
            path = out / f"{next_s}.pb"
            # protobuf messages one after the other are one with the entities of both
            path.write_bytes(b"".join(each.bytes_of("protobuf") for each in feeds))
            os.utime(path, (next_s, next_s))
            next_s, count = next_s + every_s, count + 1
        next_s = next_s or told.t_ns // SECOND_NS + 1
        clock.now_ns = told.t_ns
        board.put(told.vehicle_id, told.message, told.source, Receipt(told.t_ns))
    return count
