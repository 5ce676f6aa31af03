"""Runs a drive through the services' cores in one process, as fast as it can, without a bus."""

import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from pathlib import Path

import msgspec

from wayline.core import Choosy
from wayline.drive_file import load_drive
from wayline.messages import Message, Pose, Progress
from wayline.node import Node
from wayline.pipeline import Pipeline
from wayline.recording import JsonLines
from wayline.replayed_drive import ReplayedDrive
from wayline.route_file import load_route
from wayline.timetable.loading import load_timetable, timetable_warnings
from wayline.timetable.model import Timetable
from wayline.tuning import ArchitectureName
from wayline_replay.outages import Outage, with_outages
from wayline_replay.parts import nodes
from wayline_replay.stream import DriveStream
from wayline_replay.withheld import NOTHING, Withheld, without

Progressed = Callable[[float], None]
"""Called now and then with the seconds of the drive replayed so far."""
REPORT_EVERY = 2_000


class Summary(msgspec.Struct, frozen=True, kw_only=True):
    """What a replay did."""

    vehicle_id: str
    duration_s: float
    distance_m: float
    elapsed_s: float
    counts: dict[str, int]
    bad_input: dict[str, int]
    left_out: dict[str, Mapping[str, int]]
    """Left out on purpose, by source and reason; by slope-map, parts of the drive."""
    warnings: list[str]
    """Sources of which nothing was read beside others, and what else a user should know."""

    @property
    def real_time_factor(self) -> float:
        """How many times faster than driven."""
        return self.duration_s / self.elapsed_s if self.elapsed_s > 0.0 else 0.0


def replay(
    folder: Path,
    out: Path,
    *,
    outages: Sequence[Outage] = (),
    withheld: Withheld = NOTHING,
    database_url: str | None = None,
    route_paths: Sequence[Path] = (),
    feed_paths: Sequence[Path] = (),
    architecture: ArchitectureName | None = None,
    progressed: Progressed = lambda _: None,
) -> Summary:
    """Replay the drive in `folder`; writes `out/<topic>.jsonl`. Raises InputError.

    A drive of which nothing could be read or mapped is an error, too.

    Nothing of the result depends on the speed of the machine or the time of day. What is learned
    stays only in the database given. `architecture` goes before the drive's own.
    """
    started = time.perf_counter()
    drive = load_drive(folder)
    if architecture is not None:
        tuning = msgspec.structs.replace(drive.tuning, architecture=architecture)
        drive = msgspec.structs.replace(drive, tuning=tuning)
    if not route_paths and drive.route is not None:
        route_paths = [Path(path) for path in drive.route.paths]
    routes = tuple(load_route(path) for path in route_paths)
    assigned = [drive.assignment.name] if drive.assignment else []
    timetables = tuple(load_timetable(path, database_url) for path in feed_paths)
    stream = DriveStream(drive, str(folder))
    messages = without(stream, withheld)
    messages = with_outages(messages, outages) if outages else messages
    with JsonLines(out, drive.drive.vehicle_id) as lines:
        span = _Span(lines.write)
        behind = nodes(ReplayedDrive(drive, routes, database_url, timetables))
        pipeline = Pipeline(behind, span.publish)
        for number, received in enumerate(messages):
            pipeline.feed(received.message, received.source)
            if number % REPORT_EVERY == 0:
                progressed(span.duration_s)
        pipeline.finish()
    progressed(span.duration_s)
    return Summary(
        vehicle_id=drive.drive.vehicle_id,
        duration_s=span.duration_s,
        distance_m=span.distance_m,
        elapsed_s=time.perf_counter() - started,
        counts=lines.counts,
        bad_input=stream.bad_input,
        left_out={**stream.left_out, **dict(_left_out(behind))},
        warnings=[
            *stream.warnings,
            *timetable_warnings(timetables, assigned),
            *_without_trip(timetables, lines.counts),
        ],
    )


def _left_out(nodes: Iterable[Node]) -> Iterator[tuple[str, Mapping[str, int]]]:
    """What stores have left out of what they keep, by the node's name."""
    for node in nodes:
        if isinstance(node.store, Choosy):
            yield node.name, node.store.left_out


def _without_trip(timetables: Sequence[Timetable], counts: Mapping[str, int]) -> Iterator[str]:
    """Where no trip was found: a feed of another place or of other days tells nothing."""
    if timetables and not counts.get(Progress.topic):
        names = ", ".join(timetable.source for timetable in timetables)
        yield f"{names}: no trip fits this drive; check that the feed is of its place and its days"


class _Span:
    """Passes messages on and notes the time and distance they span."""

    def __init__(self, write: Callable[[Message, str], None]) -> None:
        self._write = write
        self._first_ns: int | None = None
        self._last_ns = 0
        self.distance_m = 0.0

    def publish(self, message: Message, source: str) -> None:
        """Write a message."""
        if self._first_ns is None:
            self._first_ns = message.t_ns
        self._first_ns = min(self._first_ns, message.t_ns)
        self._last_ns = max(self._last_ns, message.t_ns)
        if isinstance(message, Pose):
            self.distance_m = message.distance_m
        self._write(message, source)

    @property
    def duration_s(self) -> float:
        """Measurement time from the first message to the last."""
        return 0.0 if self._first_ns is None else (self._last_ns - self._first_ns) * 1e-9
