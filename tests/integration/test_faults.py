"""Faults of the live system: routers and services that go and come back, readers that stall."""

import contextlib
import json
import os
import signal
import sqlite3
import subprocess
import sys
import threading
import time
import urllib.request
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from builders import START_NS
from street import ROUTE, SPEED_MPS, VEHICLE, Receiver
from wayline.bus import Publishers, open_session
from wayline.codec import encode
from wayline.messages import FusionStatus, GpsFix, Gyro, Health, Odometer, Pose
from wayline.services import SERVICES
from wayline_cli.listener import Heard, Listener
from wayline_cli.live_check import messages_in
from wayline_cli.local_system import LocalSystem

WAIT_S = 20.0
POLL_S = 0.05
HEARD = ("gps_fix", "pose", "fusion_status", "health")


def get_json(url: str) -> Any:
    with urllib.request.urlopen(url, timeout=WAIT_S) as answer:
        return json.loads(answer.read())


def await_pose(listener: Listener, t_ns: int) -> Pose:
    heard = listener.await_message("pose", lambda h: h.message.t_ns >= t_ns, timeout_s=WAIT_S)
    assert isinstance(heard.message, Pose)
    return heard.message


def shown_up(running: LocalSystem) -> dict[str, bool]:
    """Which of the vehicle's services the dashboard shows as up."""
    (vehicle,) = get_json(f"{running.url('dashboard')}/v1/view")["vehicles"]
    return {each["service"]: each["up"] for each in vehicle["services"]}


def await_shown(running: LocalSystem, service: str, up: bool) -> None:
    deadline_s, pause = time.monotonic() + WAIT_S, threading.Event()
    while shown_up(running).get(service, False) is not up:
        assert time.monotonic() < deadline_s, f"{service} is not shown as {up}"
        pause.wait(POLL_S)


def test_when_the_router_comes_back_so_does_every_service_with_its_state(
    running: LocalSystem, receiver: Receiver, listener: Listener
) -> None:
    receiver.drive(40)
    before = await_pose(listener, receiver.t_ns)
    status = listener.heard("fusion_status")[-1].message
    assert isinstance(status, FusionStatus)
    assert before.distance_m > 300.0
    running.kill("router")
    listener.await_alive(*SERVICES, up=False, timeout_s=WAIT_S)
    running.start_router()
    back_s = time.monotonic()

    def is_back(service: str) -> Callable[[Heard], bool]:
        return lambda h: h.received_s > back_s and h.source == service

    for service in SERVICES:
        heard = listener.await_message("health", is_back(service), timeout_s=WAIT_S)
        assert heard.received_s - back_s < 5.0
    listener.await_alive(*SERVICES, timeout_s=back_s + 5.0 - time.monotonic())
    receiver.drive(5)
    after = await_pose(listener, receiver.t_ns)
    assert before.distance_m + 40.0 < after.distance_m < before.distance_m + 60.0
    latest = listener.heard("fusion_status")[-1].message
    assert isinstance(latest, FusionStatus)
    assert latest.calibration == status.calibration
    # nothing came twice with the history that subscribers ask for when they come back
    assert messages_in(running.url("fusion"))["gps_fix"] == 45
    times_ns = [heard.message.t_ns for heard in listener.heard("gps_fix")]
    assert len(set(times_ns)) == len(times_ns) == 45


@pytest.mark.parametrize("service", [each for each in SERVICES if each != "dashboard"])
def test_sigterm_ends_a_service_and_the_dashboard_shows_it_down_then_up_again(
    running: LocalSystem, listener: Listener, service: str
) -> None:
    listener.await_alive(service, timeout_s=WAIT_S)
    await_shown(running, service, True)
    assert running.stop(service, timeout_s=3.0) == 0
    listener.await_alive(service, up=False, timeout_s=1.0)
    await_shown(running, service, False)
    running.start(service)
    listener.await_alive(service, timeout_s=WAIT_S)
    await_shown(running, service, True)


def test_fusion_stopped_and_started_in_a_tunnel_knows_where_it_is(
    live_system: Callable[..., LocalSystem],
) -> None:
    """After SIGTERM, before any new fix: the bus's history holds the tunnel's empty one."""
    system = live_system()
    system.start_router()
    system.start("fusion")
    with open_session(system.bus) as session:
        listener = Listener(session, VEHICLE, HEARD)
        listener.await_alive("fusion", timeout_s=WAIT_S)
        receiver = Receiver(session, START_NS)
        receiver.drive(30)
        await_pose(listener, receiver.t_ns)
        receiver.put("gps_fix", encode(GpsFix(t_ns=receiver.t_ns + 1_000_000_000, valid=False)))
        assert system.stop("fusion") == 0
        listener.await_alive("fusion", up=False, timeout_s=WAIT_S)
        stopped = listener.heard("pose")[-1].message
        assert isinstance(stopped, Pose)
        system.start("fusion")
        listener.await_alive("fusion", timeout_s=WAIT_S)
        wheels = Odometer(t_ns=receiver.t_ns + 2_000_000_000, speed_mps=SPEED_MPS)
        receiver.put("odometer", encode(wheels))
        started = await_pose(listener, receiver.t_ns + 2_000_000_000)
        receiver.close()
        listener.close()
    assert started.mode == "dead_reckoning"
    assert stopped.lat_deg is not None
    driven_m = SPEED_MPS * (started.t_ns - stopped.t_ns) * 1e-9
    assert started.lat_deg == pytest.approx(stopped.lat_deg + driven_m / 111_300.0, abs=3e-5)
    assert started.heading_std_deg is not None
    assert started.heading_std_deg < 30.0


def test_sigterm_ends_the_dashboard(running: LocalSystem, listener: Listener) -> None:
    listener.await_alive("dashboard", timeout_s=WAIT_S)
    assert running.stop("dashboard", timeout_s=3.0) == 0
    listener.await_alive("dashboard", up=False, timeout_s=1.0)
    running.start("dashboard")
    listener.await_alive("dashboard", timeout_s=WAIT_S)


def child_of(pid: int, command: str) -> int:
    """The process that another one started by a command."""
    for children in Path(f"/proc/{pid}/task").glob("*/children"):
        for child in children.read_text().split():
            words = Path(f"/proc/{child}/cmdline").read_bytes().decode().split("\0")
            if any(word.endswith(f"/{command}") for word in words):
                return int(child)
    raise AssertionError(f"{pid} has no child {command}")


def import_s(service: str) -> float:
    """How long Python alone takes here and now for a service's modules: the load's yardstick."""
    module = f"wayline_{service.replace('-', '_')}.__main__"
    started_s = time.monotonic()
    subprocess.run([sys.executable, "-c", f"import {module}"], check=True)
    return time.monotonic() - started_s


def await_roads(url: str) -> Any:
    """The roads that the map knows, as soon as it knows any."""
    deadline_s, pause = time.monotonic() + WAIT_S, threading.Event()
    while not (roads := get_json(f"{url}/v1/roads")["roads"]):
        assert time.monotonic() < deadline_s, "no road was learned"
        pause.wait(POLL_S)
    return roads


def test_what_is_killed_under_up_is_back_soon_and_its_database_sound(
    live_system: Callable[..., LocalSystem],
) -> None:
    system = live_system(services=list(SERVICES), router=True)
    with system.config.open("a") as config:
        config.write("[tuning]\nmap_run_max_m = 500.0\n")
    wayline = Path(sys.executable).with_name("wayline")
    system.start_command("up", (str(wayline), "up", "--config", str(system.config)))
    with open_session(system.bus) as session:
        listener = Listener(session, VEHICLE, HEARD)
        listener.await_alive(*SERVICES, timeout_s=2 * WAIT_S)
        receiver = Receiver(session, time.time_ns() // 10**9 * 10**9 - 200 * 10**9)
        receiver.drive(150)
        await_pose(listener, receiver.t_ns)
        roads = await_roads(system.url("slope-map"))
        profile = get_json(f"{system.url('slope-map')}/v1/roads/{ROUTE}/profile")
        assert profile["points"]
        for service in SERVICES:
            killed_s = time.monotonic()
            os.kill(child_of(system.pid("up"), f"wayline-{service}"), signal.SIGKILL)
            listener.await_alive(service, up=False, timeout_s=1.0)
            listener.await_alive(service, timeout_s=WAIT_S)
            back_s = time.monotonic() - killed_s
            assert back_s < 3.0 or back_s < 2.0 * import_s(service)
        assert await_roads(system.url("slope-map")) == roads
        assert get_json(f"{system.url('slope-map')}/v1/roads/{ROUTE}/profile") == profile
        receiver.drive(5)
        await_pose(listener, receiver.t_ns)
        receiver.close()
        listener.close()
    assert system.stop("up") == 0
    with sqlite3.connect(system.folder / "wayline.db") as database:
        assert database.execute("PRAGMA integrity_check").fetchall() == [("ok",)]
        assert database.execute("SELECT count(*) FROM slope_ledger").fetchone()[0] >= 1
    database.close()


READER = """
import sys
import threading
from wayline.bus import open_session
from wayline.settings import BusSettings

def take(sample):
    if sys.argv[2] == "stalls":
        print("stalled", flush=True)
        threading.Event().wait()

with open_session(BusSettings(connect=(sys.argv[1],))) as session:
    subscriber = session.declare_subscriber("wayline/v1/**", take)
    print("subscribed", flush=True)
    threading.Event().wait()
"""
STEP_S = 0.005
"""Twice as fast as measured."""
STEPS = 600
FILLER = b"x" * 100_000
FILLERS = 400
"""40 MB: more than the queues and sockets between here and a reader hold."""


class Sensors:
    """A gyro and an odometer of a system with a reader, both at 100 Hz of measurement time."""

    def __init__(self, system: LocalSystem, reader: str, stack: contextlib.ExitStack) -> None:
        system.start_router()
        system.start("fusion")
        command = (sys.executable, "-c", READER, system.bus.connect[0], reader)
        system.start_command("reader", command)
        system.await_said("reader", "subscribed", WAIT_S)
        self._system, self._reader = system, reader
        self._session = stack.enter_context(open_session(system.bus))
        self._publishers = Publishers(self._session)
        stack.callback(self._publishers.close)
        self.listener = Listener(self._session, VEHICLE, ["pose", "health"])
        stack.callback(self.listener.close)
        self.listener.await_alive("fusion", timeout_s=WAIT_S)

    def fill(self) -> None:
        """Send more than a reader that stalls can be sent."""
        filler = self._session.declare_publisher("wayline/v1/filler/gps_sky/filler")
        pace = threading.Event()
        for _ in range(FILLERS):
            filler.put(FILLER)
            # slow enough that none is dropped on its way to the router
            pace.wait(0.004)
        filler.undeclare()  # type: ignore[no-untyped-call]
        if self._reader == "stalls":
            self._system.await_said("reader", "stalled", WAIT_S)

    def step(self, number: int) -> None:
        """One hundredth of a second."""
        t_ns = START_NS + number * 10_000_000
        for message in (Gyro(t_ns=t_ns, yaw_rate_degps=0.1), Odometer(t_ns=t_ns, speed_mps=9.0)):
            self._publishers.put(VEHICLE, message.topic, "can-ingest", encode(message))

    def rate_hz(self) -> float:
        """Poses a second, from the first to the last that the steps make due."""
        last_ns = START_NS + (STEPS - 1) // 10 * 100_000_000
        self.listener.await_message("pose", lambda h: h.message.t_ns >= last_ns, timeout_s=WAIT_S)
        heard = [each for each in self.listener.heard("pose") if each.message.t_ns <= last_ns]
        assert len(heard) >= STEPS // 10 - 1
        return (len(heard) - 1) / (heard[-1].received_s - heard[0].received_s)

    def dropped(self) -> int:
        """What fusion lost."""
        healths = [heard.message for heard in self.listener.heard("health")]
        return max(each.dropped for each in healths if isinstance(each, Health))


def test_a_reader_that_never_reads_does_not_slow_fusion_down(
    live_system: Callable[..., LocalSystem],
) -> None:
    with contextlib.ExitStack() as stack:
        pair = [Sensors(live_system(), reader, stack) for reader in ("reads", "stalls")]
        for sensors in pair:
            sensors.fill()
        pace = threading.Event()
        started_s = time.monotonic()
        for number in range(STEPS):
            for sensors in pair:
                sensors.step(number)
            pace.wait(started_s + (number + 1) * STEP_S - time.monotonic())
        reading_hz, stalled_hz = (sensors.rate_hz() for sensors in pair)
        assert 0.9 < stalled_hz / reading_hz < 1.1
        assert [sensors.dropped() for sensors in pair] == [0, 0]
