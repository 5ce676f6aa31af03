"""The demo as a whole: real processes, two vehicles on the page's view, and a clean end."""

import os
import queue
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import msgspec
import pytest
from websockets.sync.client import connect

from wayline.errors import InputError
from wayline_cli.demo_files import PORT_COUNT, SHUTTLE_ID, TRUCK_ID, check_ports, choose_ports
from wayline_dashboard.view import FleetView, Selection

START_S = 90.0
"""Eight Pythons that start at once on busy cores."""
LIVE_S = 90.0
"""The shuttle stands for its first 15 s, and a position alone is no heading."""
STOP_S = 20.0
WAYLINE = Path(sys.executable).with_name("wayline")


def free_row() -> int:
    """The first of as many free ports in a row as the demo uses."""
    first = 20_000 + os.getpid() % 1000 * PORT_COUNT
    for port in range(first, first + 100 * PORT_COUNT, PORT_COUNT):
        try:
            check_ports(choose_ports(port))
        except InputError:
            continue
        return port
    raise AssertionError("no row of free ports")


class Running:
    """A demo in a process of its own; `lines` is what it says."""

    def __init__(self, folder: Path) -> None:
        self.folder, self.port = folder, free_row()
        self.lines: queue.SimpleQueue[str] = queue.SimpleQueue()
        options = ("--no-open", "--first-port", str(self.port), "--keep", str(folder))
        self.process = subprocess.Popen(
            (WAYLINE, "demo", *options), stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
        )
        self._reader = threading.Thread(target=self._read)
        self._reader.start()

    def _read(self) -> None:
        assert self.process.stdout is not None
        with self.process.stdout as output:
            for line in output:
                self.lines.put(line)

    def await_line(self, text: str) -> None:
        """Wait until it says something with this text."""
        deadline_s = time.monotonic() + START_S
        while text not in self.lines.get(timeout=max(deadline_s - time.monotonic(), 0.0)):
            pass

    def processes(self) -> set[int]:
        """The processes that run on its files."""
        found = set()
        for entry in Path("/proc").glob("[0-9]*/cmdline"):
            try:
                command = entry.read_bytes()
            except OSError:
                continue
            if os.fsencode(self.folder) in command:
                found.add(int(entry.parent.name))
        return found

    def end(self) -> int:
        """Its status after SIGTERM."""
        self.process.send_signal(signal.SIGTERM)
        status = self.process.wait(STOP_S)
        self._reader.join()
        return status


@pytest.fixture
def demo(tmp_path: Path) -> Iterator[Running]:
    """A demo that has ended when the test has."""
    running = Running(tmp_path / "demo")
    yield running
    if running.process.poll() is None:
        running.end()


def seen_until_live(port: int) -> dict[str, set[str]]:
    """What the page was told of each vehicle, until there is nothing left to hope for."""
    seen: dict[str, set[str]] = {SHUTTLE_ID: set(), TRUCK_ID: set()}
    deadline_s = time.monotonic() + LIVE_S
    with connect(f"ws://127.0.0.1:{port}/v1/live", open_timeout=START_S) as page:
        page.send(msgspec.json.encode(Selection(vehicle_id=SHUTTLE_ID)).decode())
        while not ({"gps", "arrivals"} <= seen[SHUTTLE_ID] and "fused" in seen[TRUCK_ID]):
            if time.monotonic() > deadline_s:
                break
            told = msgspec.json.decode(page.recv(timeout=LIVE_S), type=FleetView)
            for vehicle in told.vehicles:
                if vehicle.pose is not None and vehicle.pose.lat_deg is not None:
                    seen[vehicle.vehicle_id].add(vehicle.pose.mode)
                if vehicle.arrivals is not None and vehicle.arrivals.stops:
                    seen[vehicle.vehicle_id].add("arrivals")
    return seen


@pytest.mark.skipif(not Path("/proc").is_dir(), reason="processes are counted in /proc")
def test_the_demo_comes_to_life_and_ends_without_a_trace(demo: Running) -> None:
    demo.await_line(f"http://127.0.0.1:{demo.port}")
    seen = seen_until_live(demo.port)
    assert {"gps", "arrivals"} <= seen[SHUTTLE_ID]
    assert "fused" in seen[TRUCK_ID]
    # the demo itself, the router, five services for both vehicles, three players
    assert len(demo.processes()) == 10
    assert demo.end() == 0
    assert demo.processes() == set()
    assert "ended with status 0" in (demo.folder / "demo.log").read_text()
