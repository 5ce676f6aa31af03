"""The processes that a fleet is played to: Wayline's own and, for the yardstick, bare ones."""

import contextlib
import http.client
import multiprocessing
import sys
import tempfile
import time
import urllib.error
import urllib.request
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import msgspec
import zenoh
from prometheus_client.parser import text_string_to_metric_families

from wayline.bus import open_session
from wayline.keys import message_key, parse_key
from wayline.messages import Arrivals, Health, Horizon, Progress
from wayline.route_file import write_route
from wayline_bench import fleet_bare
from wayline_bench.fleet_costs import core_shares, costs
from wayline_bench.fleet_feeder import FleetFeed, feed, vehicle_name
from wayline_bench.fleet_figures import (
    PROCESSES,
    SERVICES,
    Bare,
    Counters,
    Fed,
    Lived,
    Load,
    Quiet,
)
from wayline_bench.fleet_page import Page, open_page, snapshot_bytes
from wayline_bench.fleet_vehicle import TOLD_HZ, ring
from wayline_cli.local_system import LocalSystem

START_S = 40.0
POLL_S = 0.1
HEALTH_S = 1.5
"""A service's gauges are younger than that."""
CATCH_UP_S = 30.0
"""What a listener gets to work off what waits; what it has not heard then is missed."""
ANSWERS = {"eta": (Progress.topic, Arrivals.topic), "slope-map": (Horizon.topic,)}
"""What a service says of a vehicle once a second."""
WATCH_S = 8.0
SILENT_AFTER_S = 60.0


def live(load: Load) -> Lived:
    """Play a fleet to router, eta, slope-map and a dashboard with a page open.

    Raises TimeoutError where a process does not start and RuntimeError where eta or slope-map
    says nothing of a vehicle.
    """
    with _wayline() as (system, page), _sizes(system) as sizes:
        fed = _fed(_plan(system, load))
        counters = {service: _settled(system.url(service), fed) for service in SERVICES}
        snapshot = snapshot_bytes(system.url("dashboard"))
    missing = [topic for topics in ANSWERS.values() for topic in topics if topic not in sizes]
    if missing:
        raise RuntimeError(f"nobody said {', '.join(missing)} of {vehicle_name(0)}")
    page_bytes = page.bytes_between(fed.rounds_began_s, fed.rounds_ended_s)
    return Lived(fed, counters, page_bytes, snapshot, sizes)


def live_bare(load: Load, lived: Lived) -> Bare:
    """Play the same messages to a router and bare listeners.

    They hear the topics that the services heard and say as much as these, in the same sizes.
    """
    with _system() as system:
        system.start_router()
        (endpoint,) = system.bus.connect
        for service in SERVICES:
            part = _bare_part(service, load, lived)
            module = (sys.executable, "-m", fleet_bare.__name__)
            system.start_command(service, (*module, endpoint, msgspec.json.encode(part).decode()))
            system.await_said(service, fleet_bare.READY, START_S)
        fed = _fed(_plan(system, load, is_bare=True))
        for service in SERVICES:
            system.stop(service)
        heard = {service: _said_counts(system.said(service)) for service in SERVICES}
    return Bare(fed, heard)


def fall_silent(load: Load, say: Callable[[str], None]) -> tuple[Quiet, Quiet]:
    """What goes on before the first vehicle comes, and a minute after the last has gone."""
    with _wayline() as (system, _):
        time.sleep(HEALTH_S)
        before = _quiet(system)
        _fed(_plan(system, load))
        say(f"{SILENT_AFTER_S:g} s of silence")
        time.sleep(SILENT_AFTER_S)
        return before, _quiet(system)


@contextlib.contextmanager
def _system() -> Iterator[LocalSystem]:
    with tempfile.TemporaryDirectory(prefix="wayline-bench-") as name:
        folder = Path(name)
        write_route(ring(), folder / "ring.geojson")
        options = {
            "vehicles": ["*"],
            "routes": ["ring.geojson"],
            "database_url": f"sqlite:///{folder / 'wayline.db'}",
        }
        with LocalSystem(folder, **options) as system:
            yield system


@contextlib.contextmanager
def _wayline() -> Iterator[tuple[LocalSystem, Page]]:
    """Router, services and a page that looks at a vehicle; they are subscribed."""
    with _system() as system:
        system.start_router()
        for service in SERVICES:
            system.start(service)
        for service in SERVICES:
            _await_health(system, service)
        with open_page(system.url("dashboard"), vehicle_name(0)) as page:
            yield system, page


def _await_health(system: LocalSystem, service: str) -> None:
    """A service that tells its health hears. Raises TimeoutError where it does not start."""
    deadline_s = time.monotonic() + START_S
    system.await_said(service, "answers on", START_S)
    while b'"health":{' not in _get(f"{system.url(service)}/healthz", ready=False):
        if time.monotonic() > deadline_s:
            raise TimeoutError(f"{service} tells no health: {system.said(service)}")
        time.sleep(POLL_S)


@contextlib.contextmanager
def _sizes(system: LocalSystem) -> Iterator[dict[str, int]]:
    """Fills with the size of the largest message of each topic of the first vehicle."""
    sizes: dict[str, int] = {}

    def weigh(sample: zenoh.Sample) -> None:
        if (key := parse_key(str(sample.key_expr))) is not None:
            size = len(sample.payload.to_bytes())
            sizes[key.topic] = max(size, sizes.get(key.topic, 0))

    with open_session(system.bus) as session:
        scale = session.declare_subscriber(message_key(vehicle_name(0), "*", "*"), weigh)
        yield sizes
        scale.undeclare()  # type: ignore[no-untyped-call]


def _bare_part(service: str, load: Load, lived: Lived) -> fleet_bare.Part:
    topics = tuple(lived.counters[service].heard)
    answers = {topic: lived.sizes[topic] for topic in ANSWERS.get(service, ())}
    return fleet_bare.Part(topics, answers, round(load.pose_hz / TOLD_HZ))


def _plan(system: LocalSystem, load: Load, *, is_bare: bool = False) -> FleetFeed:
    return FleetFeed(system.bus, _pids(system), load, is_bare)


def _pids(system: LocalSystem) -> dict[str, int]:
    return {name: system.pid(name) for name in PROCESSES}


def _fed(plan: FleetFeed) -> Fed:
    # not forked: Zenoh's threads would not come along
    spawn = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(1, spawn) as feeder:
        return feeder.submit(feed, plan).result()


def _quiet(system: LocalSystem) -> Quiet:
    pids = _pids(system)
    before, began_s = costs(pids), time.monotonic()
    time.sleep(WATCH_S)
    shares = core_shares(before, costs(pids), time.monotonic() - began_s)
    # apart, as a listener costs the router something too
    return Quiet(shares, _heard_hz(system))


def _heard_hz(system: LocalSystem) -> float:
    heard: list[float] = []
    with open_session(system.bus) as session, contextlib.ExitStack() as stack:
        for source in ("*", "*/@adv/**"):
            ear = session.declare_subscriber(
                message_key("*", "*", source), lambda _: heard.append(time.monotonic())
            )
            stack.callback(ear.undeclare)
        time.sleep(WATCH_S)
    return len(heard) / WATCH_S


def _settled(url: str, fed: Fed) -> Counters:
    """A service's counters once it hears nothing more of what was fed, or has had long enough."""
    deadline_s = time.monotonic() + CATCH_UP_S
    counters = _counters(url)
    is_hearing = True
    while is_hearing and time.monotonic() < deadline_s:
        time.sleep(HEALTH_S)
        before, counters = counters, _counters(url)
        # health goes on: services tell theirs in the same topic
        topics = fed.sent.keys() - {Health.topic}
        is_hearing = any(before.heard.get(each) != counters.heard.get(each) for each in topics)
    return counters


def _counters(url: str) -> Counters:
    families = text_string_to_metric_families(_get(f"{url}/metrics").decode())
    samples = [sample for family in families for sample in family.samples]

    def by_topic(name: str) -> dict[str, int]:
        return {each.labels["topic"]: round(each.value) for each in samples if each.name == name}

    return Counters(
        by_topic("wayline_messages_in_total"),
        by_topic("wayline_messages_out_total"),
        round(sum(each.value for each in samples if each.name == "wayline_dropped")),
    )


def _said_counts(said: str) -> dict[str, int]:
    return msgspec.json.decode(said.splitlines()[-1], type=dict[str, int])


def _get(url: str, *, ready: bool = True) -> bytes:
    """The body of an answer; a service that lacks its input answers 503 and is not `ready`."""
    try:
        with urllib.request.urlopen(url, timeout=START_S) as answer:  # noqa: S310 - http
            body: bytes = answer.read()
    except urllib.error.HTTPError as error:
        with error:
            if ready or error.code != http.client.SERVICE_UNAVAILABLE:
                raise
            body = error.read()
    return body
