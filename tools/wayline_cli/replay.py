"""Runs a drive through all six cores in one process, as fast as it can, without a bus."""

import time
from collections.abc import Callable, Sequence
from pathlib import Path

import msgspec

from wayline.database import open_database
from wayline.drive import Drive, load_drive
from wayline.messages import Message, Pose
from wayline.node import Node
from wayline.pipeline import Pipeline
from wayline.recording import JsonLines
from wayline.route import Route, load_route
from wayline.tuning import ArchitectureName
from wayline_cli.stream import DriveStream, Outage, with_outages
from wayline_dashboard.core import DashboardCore
from wayline_eta.core import make_eta_core
from wayline_fusion.core import FusionCore
from wayline_fusion.keeping.store import FusionStore
from wayline_slope_map.core import SlopeMapCore
from wayline_slope_map.store import SlopeStore

Progressed = Callable[[float], None]
"""Called now and then with the seconds of the drive replayed so far."""
REPORT_EVERY = 2_000
IN_MEMORY = "sqlite://"


class Summary(msgspec.Struct, frozen=True, kw_only=True):
    """What a replay did."""

    vehicle_id: str
    duration_s: float
    distance_m: float
    elapsed_s: float
    counts: dict[str, int]
    bad_input: dict[str, int]

    @property
    def real_time_factor(self) -> float:
        """How many times faster than driven."""
        return self.duration_s / self.elapsed_s if self.elapsed_s > 0.0 else 0.0


def replay(
    folder: Path,
    out: Path,
    *,
    outages: Sequence[Outage] = (),
    database_url: str | None = None,
    route_path: Path | None = None,
    architecture: ArchitectureName | None = None,
    progressed: Progressed = lambda _: None,
) -> Summary:
    """Replay the drive in `folder`; writes `out/<topic>.jsonl`. Raises InputError.

    Nothing of the result depends on the speed of the machine or the time of day. What is learned
    stays only in the database given. `architecture` goes before the drive's own.
    """
    started = time.perf_counter()
    drive = load_drive(folder)
    if architecture is not None:
        tuning = msgspec.structs.replace(drive.tuning, architecture=architecture)
        drive = msgspec.structs.replace(drive, tuning=tuning)
    if route_path is None and drive.route is not None:
        route_path = Path(drive.route.path)
    route = load_route(route_path) if route_path else None
    stream = DriveStream(drive, str(folder))
    arrivals = with_outages(stream, outages) if outages else iter(stream)
    with JsonLines(out, drive.drive.vehicle_id) as lines:
        span = _Span(lines.write)
        pipeline = Pipeline(build_nodes(drive, route, database_url), span.publish)
        for number, arrival in enumerate(arrivals):
            pipeline.feed(arrival.message, arrival.source)
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
    )


def build_nodes(drive: Drive, route: Route | None, database_url: str | None) -> list[Node]:
    """The cores behind the ingest; without a database what is learned goes with the replay."""
    vehicle_id, tuning = drive.drive.vehicle_id, drive.tuning
    store = SlopeStore(open_database(database_url or IN_MEMORY, "wayline_slope_map"))
    slope_map = SlopeMapCore(
        store.load_roads(),
        tuning,
        vehicle_id,
        route=route.line if route else None,
        route_id=route.route_id if route else None,
        loop=route.loop if route else False,
    )
    return [
        fusion_node(drive, database_url),
        Node("eta", make_eta_core([route] if route else [], tuning)),
        Node("slope-map", slope_map, store),
        Node("dashboard", DashboardCore(vehicle_id)),
    ]


def fusion_node(drive: Drive, database_url: str | None) -> Node:
    """Fusion, going on from what the database knows of this vehicle."""
    vehicle_id, tuning = drive.drive.vehicle_id, drive.tuning
    if database_url is None:
        return Node("fusion", FusionCore(tuning))
    store = FusionStore(open_database(database_url, "wayline_fusion"), vehicle_id)
    return Node("fusion", FusionCore(tuning, store.load()), store)


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
