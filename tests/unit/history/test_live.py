"""The service at work: what it keeps of a drive that is live is what it keeps of it replayed."""

import threading
import time
from argparse import Namespace
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import msgspec
import pytest
import zenoh

from loops import Run
from unit.history.driven import VEHICLE, kept_of, legs
from unit.history.keeping import History
from wayline.bus import Publishers
from wayline.codec import encode
from wayline.drive_file import load_drive
from wayline.ending import Ending
from wayline.errors import InputError
from wayline.inbox import Inbox, Item, Sample
from wayline.loop import Loop
from wayline.messages import Message
from wayline.pipeline import Pipeline
from wayline.replayed_drive import ReplayedDrive
from wayline.route_file import load_route
from wayline.service import Service
from wayline.settings import Settings
from wayline_history.__main__ import build
from wayline_history.layouts import LAYOUTS
from wayline_history.replayed import PIECE_NS
from wayline_replay.parts import nodes
from wayline_replay.stream import DriveStream

EVER = (0, 2**62)
WAIT_S = 20.0
DRIVE = Path(__file__).parents[3] / "deploy" / "demo" / "avl-shuttle"
SHUTTLE = "target-shuttle"
QUIET_S = 0.5
"""What is sent over loopback has come by then."""
Open = Callable[[str], History]


def service(url: str, **options: Any) -> tuple[Service, Settings]:
    settings = Settings(vehicles=("*",), database_url=url, database_refresh_s=0.2, **options)
    return build(settings, Namespace()), settings


def all_of(history: History, vehicle_id: str) -> list[list[Any]]:
    """Everything that is kept of a vehicle, but for what only a live system has."""
    reader = history.reader
    tracks = [
        [row for each in reader.rows(vehicle_id, kind, *EVER) for row in each.values.tolist()]
        for kind in LAYOUTS
    ]
    events = reader.events(vehicle_id, *EVER, 10_000)
    return [*tracks, reader.trips(vehicle_id, *EVER), events]


def replayed(url: str) -> list[tuple[Message, str]]:
    """Everything that is on the bus in a replay of the demo's drive, which is kept at `url`."""
    drive = load_drive(DRIVE)
    told: list[tuple[Message, str]] = []
    routes = (load_route(DRIVE / "route.geojson"),)
    parts = nodes(ReplayedDrive(drive, routes, url))
    pipeline = Pipeline(parts, lambda message, source: told.append((message, source)))
    for received in DriveStream(drive, str(DRIVE)):
        pipeline.feed(received.message, received.source)
    pipeline.finish()
    return told


class CountingInbox(Inbox):
    """Knows how many messages have come."""

    def __init__(self) -> None:
        super().__init__()
        self.come = 0

    def put(self, item: Item) -> None:
        super().put(item)
        # a service that comes alive is no message
        self.come += isinstance(item, Sample)

    def await_quiet(self) -> int:
        """How many have come, once none of those that were sent several times is on its way."""
        come, pause = -1, threading.Event()
        while come != self.come:
            come = self.come
            pause.wait(QUIET_S)
        return come

    def await_items(self, count: int) -> None:
        deadline_s, pause = time.monotonic() + WAIT_S, threading.Event()
        while self.come < count:
            assert time.monotonic() < deadline_s
            pause.wait(0.001)


def test_a_live_drive_is_kept_as_the_replayed_one_is(
    session: zenoh.Session, tmp_path: Path, open_history: Open
) -> None:
    """Over a bus, each message once the one before has come: faster than driven, in its order."""
    replay_url, live_url = (f"sqlite:///{tmp_path}/{name}.db" for name in ("replay", "live"))
    made, settings = service(live_url)
    told = [each for each in replayed(replay_url) if type(each[0]) in made.core_reads]
    inbox, ending, publishers = CountingInbox(), Ending(), Publishers(session)
    with ThreadPoolExecutor(1) as threads:
        loop = threads.submit(Loop(made, settings, session, ending, inbox=inbox).run)
        first, source = told[0]
        while not inbox.come:
            # until the service has subscribed; what comes twice is kept once
            publishers.put(SHUTTLE, first.topic, source, encode(first))
        begun = inbox.await_quiet()
        for number, (message, source) in enumerate(told[1:], 1):
            publishers.put(SHUTTLE, message.topic, source, encode(message))
            inbox.await_items(begun + number)
        ending.request()
        loop.result()
    publishers.close()
    replay, live = (all_of(open_history(url), SHUTTLE) for url in (replay_url, live_url))
    assert replay == live
    assert all(replay)


def test_a_trip_that_was_under_way_when_the_service_ended_goes_on(
    run: Run, tmp_path: Path, open_history: Open
) -> None:
    url = f"sqlite:///{tmp_path}/history.db"
    drive = list(legs((60, 0.0), (200, 10.0)))
    for part in (drive[:150], drive[150:]):
        running = run(*service(url))
        running.await_start()
        for message in part:
            running.put(message, VEHICLE, "fusion")
        running.await_health(lambda health: health.backlog == 0 and health.in_rate_hz > 0)
        running.end()
    (whole,) = kept_of(drive, piece_ns=PIECE_NS).trips
    history = open_history(url)
    assert [each.trip for each in history.reader.trips(VEHICLE, *EVER)] == [whole]
    assert len(history.times_s()) == 260


def test_without_a_database_it_does_not_start() -> None:
    with pytest.raises(InputError, match="history has no database; set database_url"):
        build(Settings(vehicles=("*",)), Namespace())


def test_a_service_that_goes_and_comes_back_is_told_of_once_each(
    tmp_path: Path, open_history: Open
) -> None:
    url = f"sqlite:///{tmp_path}/history.db"
    made, _ = service(url)
    assert made.watch_alive is not None
    assert made.store is not None
    made.store.start(lambda: None)
    for is_up in (True, False, True):
        made.watch_alive(VEHICLE, "fusion", is_up)
    made.store.close()
    events = open_history(url).reader.events(VEHICLE, *EVER, 10)
    assert [(event.kind, event.name) for event in events] == [
        ("service_down", "fusion"),
        ("service_up", "fusion"),
    ]


def test_settings_are_bounded() -> None:
    with pytest.raises(msgspec.ValidationError):
        msgspec.convert({"history_days": 0}, Settings)
