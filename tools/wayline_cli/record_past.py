"""`wayline record --from --to`: what history kept of a time into an MCAP file."""

import heapq
import time
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

from wayline.mcap_log import McapWriter
from wayline.messages import Message
from wayline.parameters import read_parameters
from wayline_cli.history import Asked, opened, vehicles_asked_for
from wayline_cli.record import check_file
from wayline_history.layouts import Kind
from wayline_history.messages_again import messages_of
from wayline_history.questions import TrackParameters
from wayline_history.reading import HistoryReader

TRACKS: tuple[Kind, ...] = ("raw", "fused", "on_route")
Told = tuple[int, str, str, Message]
"""Instant, vehicle, source, message."""


def record_past(path: Path, database_url: str, asked: Asked, *, force: bool) -> Counter[str]:
    """Write the fixes, poses, places along the route and trips of a stretch of time.

    Of one vehicle or of all, in order of time, as if they had come when they were measured;
    returns how many of each topic. Raises InputError.
    """
    check_file(path, force=force)
    counts = Counter[str]()
    with opened(database_url) as reader:
        stretch = read_parameters(asked.parameters(), TrackParameters).stretch(time.time_ns())
        vehicles = vehicles_asked_for(reader, asked)
        streams = [
            _rows(reader, vehicle_id, kind, *stretch) for vehicle_id in vehicles for kind in TRACKS
        ]
        streams += [_trips(reader, vehicle_id, *stretch) for vehicle_id in vehicles]
        with McapWriter(path) as writer:
            for t_ns, vehicle_id, source, message in heapq.merge(
                *streams, key=lambda told: told[0]
            ):
                writer.write(vehicle_id, source, message, t_ns)
                counts[message.topic] += 1
    return counts


def _rows(
    reader: HistoryReader, vehicle_id: str, kind: Kind, from_ns: int, to_ns: int
) -> Iterator[Told]:
    for chunk in reader.rows(vehicle_id, kind, from_ns, to_ns):
        for source, message in messages_of(chunk):
            yield message.t_ns, vehicle_id, source, message


def _trips(reader: HistoryReader, vehicle_id: str, from_ns: int, to_ns: int) -> Iterator[Told]:
    """Those that ended in the stretch."""
    for _, trip, is_over in reader.trips(vehicle_id, from_ns, to_ns):
        if is_over and trip.t_ns < to_ns:
            yield trip.t_ns, vehicle_id, "history", trip
