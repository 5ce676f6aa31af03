"""A drive's messages in order of arrival, from all its recordings."""

import heapq
import itertools
from collections.abc import Iterable, Iterator, Sequence
from typing import NamedTuple

from wayline.arrival import Arrival, in_order
from wayline.drive import Drive
from wayline.messages import GpsFix
from wayline_can_ingest import recorded as can
from wayline_gps_ingest import recorded as gps

HEAD_NS = 5_000_000_000
"""A drive's smallest t_ns comes within this much arrival time of its first message."""


class Outage(NamedTuple):
    """GPS taken away, in seconds from the drive's smallest t_ns."""

    start_s: float
    length_s: float


class DriveStream:
    """Iterates once over a drive's messages in order of arrival.

    `where` names the drive file in errors. Raises InputError.
    """

    def __init__(self, drive: Drive, where: str) -> None:
        self._recordings = [*gps.recordings(drive), *can.recordings(drive, where)]

    def __iter__(self) -> Iterator[Arrival]:
        return heapq.merge(
            *(in_order(order, recording) for order, recording in enumerate(self._recordings)),
            key=lambda arrival: arrival[:2],
        )

    @property
    def bad_input(self) -> dict[str, int]:
        """Sentences, rows and frames that were counted and dropped so far, by source."""
        return {recording.source: recording.bad_input() for recording in self._recordings}


def with_outages(arrivals: Iterable[Arrival], outages: Sequence[Outage]) -> Iterator[Arrival]:
    """Blank position, speed, course and altitude of every fix measured during an outage."""
    stream = iter(arrivals)
    head = _head(stream)
    if not head:
        return
    start_ns = min(arrival.message.t_ns for arrival in head)
    spans = [
        (start_ns + round(start_s * 1e9), start_ns + round((start_s + length_s) * 1e9))
        for start_s, length_s in outages
    ]
    for arrival in itertools.chain(head, stream):
        message = arrival.message
        if isinstance(message, GpsFix) and any(a <= message.t_ns < b for a, b in spans):
            yield arrival._replace(message=blanked(message))
        else:
            yield arrival


def blanked(fix: GpsFix) -> GpsFix:
    """The fix of a receiver that sees no satellites."""
    return GpsFix(t_ns=fix.t_ns, valid=False, satellites=0)


def _head(stream: Iterator[Arrival]) -> list[Arrival]:
    head: list[Arrival] = []
    for arrival in stream:
        head.append(arrival)
        if arrival.arrival_ns - head[0].arrival_ns > HEAD_NS:
            break
    return head
