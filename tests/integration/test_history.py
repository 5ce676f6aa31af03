"""What happened outlives the history process, its database and its disk; holes are told."""

import contextlib
import json
import random
import threading
import time
import urllib.error
import urllib.request
from collections.abc import Callable, Iterator
from datetime import datetime
from pathlib import Path
from typing import Any

import pytest

from postgres import Cluster
from siege.disk import small_disk
from street import VEHICLE, Receiver
from wayline.bus import open_session
from wayline_cli.listener import Listener
from wayline_cli.local_system import LocalSystem

WAIT_S = 30.0
PIECE_S = 10
"""So much waits to be handed over while the vehicle drives."""
TOLD_S = 6.0
"""So long a time in which nothing could be kept is told as a gap."""
POLL_S = 0.1
RETRY = {"database_retry_s": 0.2, "database_refresh_s": 0.2}


class Watched:
    """A vehicle on its street, located by fusion and written down by history."""

    def __init__(self, system: LocalSystem, receiver: Receiver, listener: Listener) -> None:
        self.system, self._receiver, self._listener = system, receiver, listener
        self._start_ns = receiver.t_ns

    def drive(self, seconds: int) -> None:
        """Drive on; returns when fusion has said where that led."""
        self._receiver.drive(seconds)
        until_ns = self._receiver.t_ns
        self._listener.await_message(
            "pose", lambda heard: heard.message.t_ns >= until_ns, timeout_s=WAIT_S
        )

    def start_history(self) -> None:
        """Start the service, again or for the first time; returns when it listens."""
        self.system.start("history")
        self._listener.await_alive("history", timeout_s=WAIT_S)

    def kill_history(self) -> None:
        """As a crash would; returns when the bus knows."""
        self.system.kill("history")
        self._listener.await_alive("history", up=False, timeout_s=WAIT_S)

    def kept(self) -> set[int]:
        """The seconds of Unix time of which history tells a pose."""
        points = self._asked("track")["points"]
        return {int(datetime.fromisoformat(each["t"]).timestamp()) for each in points}

    def published(self) -> set[int]:
        """The seconds of Unix time of which fusion told a pose."""
        return {heard.message.t_ns // 10**9 for heard in self._listener.heard("pose")}

    def events(self, kind: str) -> list[dict[str, Any]]:
        """What history tells of one kind."""
        return [each for each in self._asked("events")["events"] if each["kind"] == kind]

    def await_kept(self, but_for: int = 0) -> None:
        """Wait until history tells of every second that fusion told of, the last ones excepted."""
        wanted = set(sorted(self.published())[: -but_for or None])
        await_true(lambda: self.is_answering() and wanted <= self.kept())

    def is_answering(self) -> bool:
        """Whether the drive can be asked for."""
        try:
            self._asked("track")
        except urllib.error.HTTPError as refused:
            if refused.code in {404, 503}:
                return False
            raise
        return True

    def problem(self) -> str:
        """What history says that it lacks."""
        try:
            urllib.request.urlopen(f"{self.system.url('history')}/healthz", timeout=WAIT_S).close()
        except urllib.error.HTTPError as unwell:
            return unwell.read().decode()
        return ""

    def _asked(self, what: str) -> Any:
        start_s = self._start_ns * 1e-9 - 60.0
        url = f"{self.system.url('history')}/v1/vehicles/{VEHICLE}/{what}?from={start_s}"
        with urllib.request.urlopen(url, timeout=WAIT_S) as answer:
            return json.loads(answer.read())


@contextlib.contextmanager
def watched(folder: Path, database_url: str) -> Iterator[Watched]:
    with contextlib.ExitStack() as stack:
        system = LocalSystem(folder, vehicle_id=VEHICLE, database_url=database_url, **RETRY)
        stack.enter_context(system)
        system.start_router()
        system.start("fusion")
        session = stack.enter_context(open_session(system.bus))
        listener = Listener(session, VEHICLE, ("pose",))
        stack.callback(listener.close)
        listener.await_alive("fusion", timeout_s=WAIT_S)
        now_s = time.time_ns() // 10**9
        receiver = Receiver(session, (now_s - 600) * 10**9)
        stack.callback(receiver.close)
        watched = Watched(system, receiver, listener)
        watched.start_history()
        yield watched


def await_true(holds: Callable[[], bool]) -> None:
    deadline_s, pause = time.monotonic() + WAIT_S, threading.Event()
    while not holds():
        assert time.monotonic() < deadline_s
        pause.wait(POLL_S)


def assert_gap_of_database(drive: Watched) -> None:
    (gap,) = drive.events("gap")
    assert gap["detail"] == "the database was away or full"
    since, until = (datetime.fromisoformat(gap[name]) for name in ("t", "until"))
    assert (until - since).total_seconds() >= TOLD_S


@pytest.mark.parametrize("seed", [1, 2])
def test_what_was_told_before_a_kill_is_told_after_it(
    tmp_path: Path, database_url: str, seed: int
) -> None:
    with watched(tmp_path, database_url) as drive:
        drive.drive(40)
        await_true(drive.is_answering)
        time.sleep(random.Random(seed).uniform(0.0, 1.0))
        told = drive.kept()
        assert told
        drive.kill_history()
        drive.drive(20)
        drive.start_history()
        drive.drive(20)
        await_true(lambda: drive.is_answering() and max(drive.published()) in drive.kept())
        assert told <= drive.kept()
        (gap,) = drive.events("gap")
        assert gap["name"] == "history"


def test_a_server_that_is_away_costs_no_pose(tmp_path: Path, postgres: Cluster) -> None:
    with watched(tmp_path, postgres.new_url()) as drive:
        drive.drive(30)
        drive.await_kept(but_for=PIECE_S)
        postgres.stop("immediate")
        try:
            drive.drive(60)
            await_true(lambda: not drive.is_answering())
            time.sleep(TOLD_S)
        finally:
            postgres.start()
        drive.drive(30)
        drive.await_kept()
        assert_gap_of_database(drive)


def test_a_full_disk_costs_no_pose(tmp_path: Path) -> None:
    with small_disk(tmp_path / "disk") as disk:
        if disk is None:
            pytest.skip("mounting is not allowed here")
        with watched(tmp_path, f"sqlite:///{disk.folder}/history.db") as drive:
            drive.drive(30)
            drive.await_kept(but_for=PIECE_S)
            with disk.full():
                drive.drive(60)
                await_true(lambda: "full" in drive.problem())
                time.sleep(TOLD_S)
            drive.drive(30)
            drive.await_kept()
            assert_gap_of_database(drive)
