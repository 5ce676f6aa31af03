"""What views are told, how old it is, and what of a silent vehicle is left."""

import queue
import threading
import time
from typing import ClassVar

import msgspec
import pytest
import zenoh

from builders import at, fix
from echoing import ALL, ONE, Bug, Echo, Told, echo
from loops import WAIT_S, Run, Running
from wayline.keys import FLEET, alive_key, message_key
from wayline.messages import Health, Message, Odometer, Pose
from wayline.node import Node
from wayline.receipts import EACH_MAX
from wayline.service import Service
from wayline.settings import Settings
from wayline.view import Receipt


def test_views_hear_everything_and_who_comes_and_goes(run: Run, session: zenoh.Session) -> None:
    told: queue.SimpleQueue[tuple[str, str, str]] = queue.SimpleQueue()
    alive: queue.SimpleQueue[tuple[str, str, bool]] = queue.SimpleQueue()
    service = echo()
    service.views = [Told(told)]
    service.watch_alive = lambda *event: alive.put(event)
    running = run(service, ALL)
    assert alive.get(timeout=WAIT_S) == (FLEET, "echo", True)
    token = session.liveliness().declare_token(alive_key("bus-9", "gps-ingest"))
    assert alive.get(timeout=WAIT_S) == ("bus-9", "gps-ingest", True)
    token.undeclare()  # type: ignore[no-untyped-call]
    assert alive.get(timeout=WAIT_S) == ("bus-9", "gps-ingest", False)
    running.put(fix(0.05, 55.0, 10.0), "bus-9")
    found = {told.get(timeout=WAIT_S) for _ in range(3)}
    assert found >= {("bus-9", "gps_fix", "test"), ("bus-9", "odometer", "echo")}
    assert (FLEET, "health", "echo") in found


def test_what_only_a_view_reads_is_heard_and_does_not_reach_the_core(run: Run) -> None:
    told: queue.SimpleQueue[tuple[str, str, str]] = queue.SimpleQueue()
    service = Service("echo", lambda *_: Node("echo", Bug()), Bug.reads, views=[Told(told)])
    running = run(service, ONE)
    running.await_start()
    running.put(Pose(t_ns=at(0), mode="starting"))
    while (found := told.get(timeout=WAIT_S)) != ("bus-7", "pose", "test"):
        assert found == ("bus-7", "health", "echo")
    running.await_health(lambda health: health.in_rate_hz == 0.0)
    running.end()


def test_a_service_without_a_core_only_shows(run: Run) -> None:
    told: queue.SimpleQueue[tuple[str, str, str]] = queue.SimpleQueue()
    running = run(Service("page", views=[Told(told)]), ALL)
    running.await_start()
    running.put(Pose(t_ns=at(0), mode="starting"), "bus-9")
    while (found := told.get(timeout=WAIT_S)) != ("bus-9", "pose", "test"):
        assert found == (FLEET, "health", "page")


def shown(running: Running, view: Told, message: Message, vehicle_id: str) -> Receipt:
    """The receipt with which a view was told of a message."""
    view.receipts.pop(vehicle_id, None)
    running.put(message, vehicle_id)
    deadline_s = time.monotonic() + WAIT_S
    while vehicle_id not in view.receipts:
        assert time.monotonic() < deadline_s
        time.sleep(0.01)
    return view.receipts[vehicle_id]


def told_age_s(running: Running, view: Told, t_ns: int, vehicle_id: str) -> float:
    receipt = shown(running, view, Pose(t_ns=t_ns, mode="starting"), vehicle_id)
    return receipt.age_s(receipt.at_ns)


HOUR_S = 3600.0


def test_a_message_is_as_old_as_it_says_but_for_a_recording_that_is_played(run: Run) -> None:
    """Health says which; until it has been heard nothing is called old for five seconds."""
    view = Told(queue.SimpleQueue())
    running = run(Service("page", views=[view]), ALL)
    running.await_start()
    old_ns = time.time_ns() - round(HOUR_S * 1e9)
    assert told_age_s(running, view, time.time_ns(), "live") < 1.0
    assert told_age_s(running, view, old_ns, "played") == 0.0
    health = Health(t_ns=old_ns, service="gps-ingest", version="0", started_ns=old_ns)
    running.put(health, "late", "gps-ingest")
    running.put(msgspec.structs.replace(health, recorded=True), "played", "play")
    deadline_s = time.monotonic() + WAIT_S
    while told_age_s(running, view, old_ns, "late") == 0.0:
        assert time.monotonic() < deadline_s
    assert told_age_s(running, view, old_ns, "late") == pytest.approx(HOUR_S, abs=WAIT_S)
    assert told_age_s(running, view, old_ns, "played") == 0.0


def test_a_message_an_hour_ahead_is_refused_but_for_a_recording_that_is_played(run: Run) -> None:
    view = Told(queue.SimpleQueue())
    running = run(Service("page", views=[view]), ALL)
    running.await_start()
    ahead_ns = time.time_ns() + round(HOUR_S * 1e9)
    for vehicle_id in ("live", "played"):
        running.put(Pose(t_ns=ahead_ns, mode="starting"), vehicle_id)
    assert running.await_health(lambda health: health.bad_input == 2)
    assert view.receipts.keys() == {FLEET}
    health = Health(t_ns=time.time_ns(), service="play", version="0", started_ns=time.time_ns())
    running.put(msgspec.structs.replace(health, recorded=True), "played", "play")
    deadline_s = time.monotonic() + WAIT_S
    while "played" not in view.receipts:
        running.put(Pose(t_ns=ahead_ns, mode="starting"), "played")
        assert time.monotonic() < deadline_s
        time.sleep(0.1)
    assert told_age_s(running, view, ahead_ns, "played") == 0.0


def test_a_clock_that_is_not_plausible_refuses_nothing(
    run: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    true_ns = time.time_ns
    monkeypatch.setattr(time, "time_ns", lambda: 60_000_000_000)
    view = Told(queue.SimpleQueue())
    running = run(Service("page", views=[view]), ALL)
    running.await_start()
    assert told_age_s(running, view, true_ns(), "bus-7") == 0.0


def test_no_step_of_the_hosts_clock_makes_a_vehicle_old(
    run: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    view = Told(queue.SimpleQueue())
    running = run(Service("page", views=[view]), ALL)
    running.await_start()
    true_ns = time.time_ns
    told_age_s(running, view, true_ns(), "bus-7")
    # that it is no recording is known to whoever asks
    health = Health(t_ns=true_ns(), service="gps-ingest", version="0", started_ns=true_ns())
    running.put(health, source="gps-ingest")
    for step_s in (HOUR_S, -HOUR_S):
        monkeypatch.setattr(time, "time_ns", lambda s=step_s: true_ns() + round(s * 1e9))
        for _ in range(5):
            assert told_age_s(running, view, true_ns(), "bus-7") < 1.0
            time.sleep(0.1)


def test_a_silent_vehicle_is_forgotten_with_what_it_cost_and_comes_back(run: Run) -> None:
    view = Told(queue.SimpleQueue())
    made: list[str] = []

    def make_node(vehicle_id: str, source: str) -> Node:
        made.append(vehicle_id)
        return Node("echo", Echo())

    service = Service("echo", make_node, Echo.reads, views=[view])
    running = run(service, Settings(vehicles=("*",), forget_vehicle_after_s=2.0))
    running.await_start()
    running.put(fix(0.05, 55.0, 10.0), "bus-8")
    wanted = Odometer(t_ns=at(0.05), speed_mps=4.0)
    # the end of input, so that what was learned is kept
    running.listener.await_message(
        "odometer",
        lambda h: isinstance(h.message, Odometer) and h.message.speed_mps == wanted.speed_mps,
        timeout_s=WAIT_S,
    )
    deadline_s = time.monotonic() + WAIT_S
    while view.forgotten != ["bus-8"]:
        assert time.monotonic() < deadline_s
        time.sleep(0.01)
    ticks = len(running.listener.heard("odometer"))
    running.await_health(lambda health: health.out_rate_hz == 0.0)
    assert len(running.listener.heard("odometer")) == ticks
    running.put(fix(10.05, 55.0, 10.0), "bus-8")
    running.await_odometer(at(10.05), 1.0)
    assert made == ["bus-8", "bus-8"]


def test_a_named_vehicle_is_never_forgotten(run: Run) -> None:
    view = Told(queue.SimpleQueue())
    service = Service("echo", lambda *_: Node("echo", Echo()), Echo.reads, views=[view])
    running = run(service, Settings(vehicle_id="bus-7", forget_vehicle_after_s=0.5))
    running.await_start()
    running.put(fix(0.05, 55.0, 10.0))
    running.await_odometer(at(3.0), 2.0)
    assert view.forgotten == []


def test_more_sources_than_a_vehicle_has_are_made_up(run: Run) -> None:
    running = run(echo(), ONE)
    running.await_start()
    for number in range(20):
        running.put(fix(number, 55.0, 10.0), source=f"gps-ingest-{number}")
    assert running.await_health(lambda health: health.bad_input >= 4).bad_input == 4


def test_of_a_silent_vehicle_nothing_is_said_any_more(
    run: Run, session: zenoh.Session, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Not even what its last message was, as publishers do every few seconds."""
    monkeypatch.setattr("wayline.loop.QUIET_S", 2.0)
    heartbeats: queue.SimpleQueue[float] = queue.SimpleQueue()
    key = message_key("bus-8", "odometer", "echo")
    hears = session.declare_subscriber(
        f"{key}/@adv/pub/**", lambda _: heartbeats.put(time.monotonic())
    )

    class Patient(Echo):
        period_ns: ClassVar[int | None] = None

    running = run(Service("echo", lambda *_: Node("echo", Patient()), Echo.reads), ALL)
    running.await_start()
    running.put(fix(0.05, 55.0, 10.0), "bus-8")
    heartbeats.get(timeout=WAIT_S)
    # the publisher goes within a second of its time, the heartbeats come once a second
    time.sleep(4.0)
    quiet_since_s = time.monotonic()
    time.sleep(2.5)
    while not heartbeats.empty():
        assert heartbeats.get() < quiet_since_s
    running.put(fix(0.15, 55.0, 10.0), "bus-8")
    running.await_odometer(at(0.15), 1.0)
    hears.undeclare()  # type: ignore[no-untyped-call]


def test_of_a_whole_fleet_that_is_old_health_is_heard_by_one_subscription(run: Run) -> None:
    """As of an agency's reports; a thread for each vehicle filled a core. Played ones are known."""
    view = Told(queue.SimpleQueue())
    running = run(Service("page", views=[view]), ALL)
    running.await_start()
    old_ns = time.time_ns() - round(HOUR_S * 1e9)
    names = [f"bus-{number}" for number in range(3 * EACH_MAX)]
    threads = threading.active_count()
    for name in names:
        told_age_s(running, view, old_ns, name)
    assert threading.active_count() < threads + EACH_MAX
    health = Health(t_ns=old_ns, service="gps-ingest", version="0", started_ns=old_ns)
    for name in names:
        running.put(msgspec.structs.replace(health, recorded=name != names[-1]), name, "play")
    deadline_s = time.monotonic() + WAIT_S
    while told_age_s(running, view, old_ns, names[-1]) == 0.0:
        assert time.monotonic() < deadline_s
    assert {told_age_s(running, view, old_ns, name) for name in names[:-1]} == {0.0}
