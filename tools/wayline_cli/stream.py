"""A drive's messages in order of arrival, from its recordings through the ingest cores."""

import heapq
import itertools
from collections.abc import Callable, Iterable, Iterator, Sequence
from pathlib import Path
from typing import NamedTuple, TypeVar

import msgspec

from wayline.avl_log import read_reports
from wayline.can_log import CanLog
from wayline.drive import AvlSource, CanSource, Drive, NmeaSource, Vehicle
from wayline.errors import InputError
from wayline.inputs import Flush, PositionReport
from wayline.messages import GpsFix, Message
from wayline.nmea_log import has_date, read_sentences
from wayline_can_ingest.core import CanIngestCore
from wayline_can_ingest.dbc import load_databases
from wayline_can_ingest.mapping import compile_mapping
from wayline_gps_ingest.core import GpsIngestCore

HEAD_NS = 5_000_000_000
"""A drive's smallest t_ns comes within this much arrival time of its first message."""


class Arrival(NamedTuple):
    """A message as it reaches the bus."""

    arrival_ns: int
    order: int
    """Of its source among the drive's sources: nmea, avl, can; settles ties."""
    source: str
    message: Message


class Outage(NamedTuple):
    """GPS taken away, in seconds from the drive's smallest t_ns."""

    start_s: float
    length_s: float


class DriveStream:
    """Iterates once over a drive's messages in order of arrival.

    `where` names the drive file in errors. After the iteration `bad_input` tells, by source, what
    was counted and dropped.
    """

    def __init__(self, drive: Drive, where: str) -> None:
        self._counters: dict[str, Callable[[], int]] = {}
        vehicle = drive.vehicle
        gps_names, can_names = _names("gps-ingest"), _names("can-ingest")
        readers: list[Iterator[tuple[int, str, Message]]] = []
        for nmea in drive.nmea:
            readers.append(self._nmea(nmea, vehicle, next(gps_names)))
        for avl in drive.avl:
            readers.append(self._avl(avl, vehicle, next(gps_names)))
        for can in drive.can:
            readers.append(self._can(can, vehicle, where, next(can_names)))
        self._readers = readers

    def __iter__(self) -> Iterator[Arrival]:
        return heapq.merge(
            *(_in_order(order, reader) for order, reader in enumerate(self._readers)),
            key=lambda arrival: arrival[:2],
        )

    @property
    def bad_input(self) -> dict[str, int]:
        """Sentences, rows and frames that were counted and dropped so far, by source."""
        return {name: count() for name, count in self._counters.items()}

    def _nmea(
        self, source: NmeaSource, vehicle: Vehicle, name: str
    ) -> Iterator[tuple[int, str, Message]]:
        path = Path(source.path)
        if source.date is None and not has_date(path):
            raise InputError(
                str(path), "no sentence carries a date", "add date = YYYY-MM-DD to its [[nmea]]"
            )
        core = GpsIngestCore(vehicle.gps_latency_s, source.date)
        self._counters[name] = lambda: core.bad_input
        latency_ns = round(vehicle.gps_latency_s * 1e9)
        return _translated(
            read_sentences(path),
            core.handle,
            name,
            lambda sentence, message: (
                message.t_ns + latency_ns if sentence.arrival_ns is None else sentence.arrival_ns
            ),
        )

    def _avl(
        self, source: AvlSource, vehicle: Vehicle, name: str
    ) -> Iterator[tuple[int, str, Message]]:
        core = GpsIngestCore(vehicle.gps_latency_s)
        log = _Readable(read_reports(source))
        self._counters[name] = lambda: core.bad_input + log.bad_input
        return _translated(log, core.handle, name, lambda report, _: report.t_ns)

    def _can(
        self, source: CanSource, vehicle: Vehicle, where: str, name: str
    ) -> Iterator[tuple[int, str, Message]]:
        databases = load_databases([Path(path) for path in source.dbc])
        mapping = compile_mapping(source, databases, vehicle, where)
        core = CanIngestCore(source, mapping, vehicle, channel=source.channel)
        log = CanLog([Path(path) for path in source.paths])
        self._counters[name] = lambda: core.bad_input + core.dropped + log.bad_input
        return _translated(log, core.handle, name, lambda frame, _: core.arrival_ns(frame))


Raw = TypeVar("Raw", bound=msgspec.Struct)


class _Readable:
    """Passes on the rows that could be read and counts the others."""

    def __init__(self, rows: Iterable[PositionReport | None]) -> None:
        self._rows = rows
        self.bad_input = 0

    def __iter__(self) -> Iterator[PositionReport]:
        for row in self._rows:
            if row is None:
                self.bad_input += 1
            else:
                yield row


def _translated(
    inputs: Iterable[Raw],
    handle: Callable[[msgspec.Struct, str], Sequence[Message]],
    name: str,
    arrival_ns: Callable[[Raw, Message], int],
) -> Iterator[tuple[int, str, Message]]:
    """Messages that an ingest core makes of raw input, with their arrival and source."""
    last: Raw | None = None
    for last in inputs:
        for message in handle(last, name):
            yield arrival_ns(last, message), name, message
    if last is not None:
        for message in handle(Flush(0), name):
            yield arrival_ns(last, message), name, message


def _in_order(order: int, messages: Iterable[tuple[int, str, Message]]) -> Iterator[Arrival]:
    """Arrivals of one source, never earlier than the one before."""
    latest_ns = 0
    for arrival_ns, name, message in messages:
        latest_ns = max(latest_ns, arrival_ns)
        yield Arrival(latest_ns, order, name, message)


def _names(service: str) -> Iterator[str]:
    """`gps-ingest`, `gps-ingest-2`, ..."""
    yield service
    for number in itertools.count(2):
        yield f"{service}-{number}"


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
