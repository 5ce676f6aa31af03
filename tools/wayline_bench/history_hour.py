"""An hour of a fleet at one pose a second, through history's own loop, as fast as it goes."""

import json
import threading
import time
from argparse import Namespace
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import NamedTuple

import psutil
import zenoh

from wayline.codec import encode
from wayline.ending import Ending
from wayline.inbox import Inbox, Sample
from wayline.keys import message_key
from wayline.loop import Loop
from wayline.messages import Pose
from wayline.patient_store import PatientStore
from wayline.settings import Settings
from wayline_bench.history_drives import drive
from wayline_history.__main__ import build
from wayline_history.kept import HistoryTables

FLEET = 500
HOUR_S = 3_600.0
BACKLOG_MAX = 5_000
PAUSE_S = 0.002


Waits = PatientStore[HistoryTables]


class KeptHour(NamedTuple):
    """What it took."""

    cpu_s: float
    """Of all threads, feeding included, until everything was kept."""
    first_mb: float
    """The process's memory when a quarter was kept, and in the end."""
    last_mb: float


def keep_hour(database_url: str, progressed: Callable[[float], None]) -> KeptHour:
    """Keep the hour in a new database."""
    settings = Settings(vehicles=("*",), database_url=database_url)
    service = build(settings, Namespace())
    store, inbox, ending = service.store, Inbox(), Ending()
    if not isinstance(store, PatientStore):
        raise AssertionError("history has a store that waits for its database")
    payloads = [encode(pose) for pose in drive(int(HOUR_S))]
    keys = [message_key(f"bus-{number}", Pose.topic, "fusion") for number in range(FLEET)]
    with zenoh.open(_alone()) as session, ThreadPoolExecutor(1) as threads:
        loop = Loop(service, settings, session, ending, inbox=inbox)
        started_s = time.process_time()
        running = threads.submit(loop.run)
        first_mb = 0.0
        for second, payload in enumerate(payloads):
            _put(inbox, store, keys, payload)
            if second == len(payloads) // 4:
                first_mb = _memory_mb()
            if second % 60 == 0:
                progressed(second / len(payloads))
        while inbox.backlog or store.backlog:
            time.sleep(PAUSE_S)
        last_mb = _memory_mb()
        ending.request()
        running.result()
        if loop.dropped or store.detail:
            raise AssertionError(f"{loop.dropped} messages dropped; {store.detail}")
        return KeptHour(time.process_time() - started_s, first_mb, last_mb)


def _put(inbox: Inbox, store: Waits, keys: list[str], payload: bytes) -> None:
    """A pose of every vehicle, once there is room for it: nothing is to be dropped."""
    received_ns, heard_ns = time.time_ns(), time.monotonic_ns()
    for key in keys:
        inbox.put(Sample(key, payload, received_ns, heard_ns))
    pause = threading.Event()
    while inbox.backlog > BACKLOG_MAX or store.backlog > BACKLOG_MAX:
        pause.wait(PAUSE_S)


def _memory_mb() -> float:
    return float(psutil.Process().memory_info().rss) / 1e6


def _alone() -> zenoh.Config:
    """A session that reaches nobody."""
    config = zenoh.Config()
    config.insert_json5("listen/endpoints", json.dumps([]))
    config.insert_json5("scouting/multicast/enabled", "false")
    config.insert_json5("timestamping/enabled", "true")
    return config
