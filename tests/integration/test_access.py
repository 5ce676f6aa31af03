"""Access control with real sessions: deploy/zenoh/server.json5 as the router has it.

Where nothing may arrive, the same session then sends something allowed over the same way: once
that is there, the forbidden one would have been.
"""

import contextlib
import itertools
import json
import queue
import socket
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
import zenoh

from wayline.bus import Publishers, Subscription, client_config
from wayline.keys import FLEET, alive_key, message_key, query_key
from wayline.settings import BusSettings
from wayline_cli.access import access_control

ZENOH = Path(__file__).parents[2] / "deploy/zenoh"
WAIT_S = 10.0
PASSWORDS = {"bus-1": "one", "bus-2": "two", "_services": "three", "_dashboard": "four"}

BY = {"pose": "fusion", "progress": "eta", "arrivals": "eta", "horizon": "slope-map"}
"""Who publishes a topic."""

Samples = queue.Queue[tuple[str, str]]
"""Key and payload of what arrived."""


class Bus:
    """Routers of this test and the sessions opened on them, closed at its end."""

    def __init__(self, folder: Path) -> None:
        self.users = folder / "users"
        self.users.write_text("".join(f"{u}:{p}\n" for u, p in PASSWORDS.items()))
        self.port = free_port()
        self._sessions: list[zenoh.Session] = []
        # Zenoh undeclares what nobody holds any more
        self._held: list[object] = []

    def start_router(self, name: str, port: int, **entries: object) -> None:
        """A router with a file of deploy/zenoh, its addresses and files replaced."""
        config = zenoh.Config.from_file(str(ZENOH / name))
        entries["listen/endpoints"] = [f"tcp/127.0.0.1:{port}"]
        entries["transport/auth/usrpwd/dictionary_file"] = str(self.users)
        for key, value in entries.items():
            config.insert_json5(key, json.dumps(value))
        self._sessions.append(zenoh.open(config))

    def restart_router(self, name: str, **entries: object) -> None:
        """End the first router and start it anew, as for another vehicle."""
        self._sessions.pop(0).close()  # type: ignore[no-untyped-call]
        self.start_router(name, self.port, **entries)
        self._sessions.insert(0, self._sessions.pop())

    def connect(
        self, user: str | None, password: str | None = None, port: int | None = None
    ) -> zenoh.Session:
        """A service's session; raises where the router refuses it."""
        given = password or PASSWORDS.get(user or "")
        endpoint = f"tcp/127.0.0.1:{port or self.port}"
        config = client_config(BusSettings(connect=(endpoint,), user=user, password=given))
        # a service waits for its router; here a refusal has to end
        config.insert_json5("connect/timeout_ms", "1000")
        config.insert_json5("connect/exit_on_failure", "true")
        session = zenoh.open(config)
        self._sessions.append(session)
        return session

    def hear(self, session: zenoh.Session, vehicle_id: str, topic: str) -> Samples:
        """What arrives of a topic, as the services subscribe."""
        samples: Samples = queue.Queue()

        def take(key: str, payload: bytes) -> None:
            samples.put((key, payload.decode()))

        self._held.append(Subscription(session, [vehicle_id], [topic], take))
        return samples

    def hear_alive(self, session: zenoh.Session, vehicle_id: str = "*") -> Samples:
        """Liveliness of every service."""
        samples: Samples = queue.Queue()

        def take(sample: zenoh.Sample) -> None:
            samples.put((str(sample.key_expr), str(sample.kind)))

        key, liveliness = alive_key(vehicle_id, "*"), session.liveliness()
        self._held.append(liveliness.declare_subscriber(key, take, history=True))
        return samples

    def put(
        self,
        session: zenoh.Session,
        vehicle_id: str,
        topic: str,
        *payloads: str,
        source: str | None = None,
    ) -> None:
        """Publish as the services do."""
        publishers = Publishers(session)
        self._held.append(publishers)
        for payload in payloads:
            publishers.put(vehicle_id, topic, source or BY[topic], payload.encode())

    def live(self, session: zenoh.Session, vehicle_id: str, service: str) -> None:
        """Declare a service's liveliness."""
        token = session.liveliness().declare_token(alive_key(vehicle_id, service))
        self._held.append(token)

    def answer(
        self, session: zenoh.Session, key: str, reply: Callable[[zenoh.Query], None]
    ) -> None:
        """Answer queries."""
        self._held.append(session.declare_queryable(key, reply))

    def close(self) -> None:
        """Clients first, so that none of them looks for its router."""
        for session in reversed(self._sessions):
            session.close()  # type: ignore[no-untyped-call]


@pytest.fixture
def bus(tmp_path: Path) -> Iterator[Bus]:
    """The server's router with its access control, for vehicles bus-1 and bus-2."""
    bus = Bus(tmp_path)
    bus.start_router("server.json5", bus.port)
    yield bus
    bus.close()


def free_port() -> int:
    with socket.create_server(("127.0.0.1", 0)) as listening:
        return int(listening.getsockname()[1])


def arrived(samples: Samples) -> tuple[str, str]:
    """The next vehicle and payload."""
    key, payload = samples.get(timeout=WAIT_S)
    return key.split("/")[2], payload


def answers(session: zenoh.Session, key: str) -> list[str]:
    replies = session.get(key, timeout=WAIT_S, accept_replies=zenoh.ReplyKeyExpr.ANY)
    return [reply.ok.payload.to_string() for reply in replies if reply.ok]


def first_answers(session: zenoh.Session, key: str) -> list[str]:
    """Ask until somebody answers: a queryable of another session takes a moment to be known."""
    until_s = time.monotonic() + WAIT_S
    while time.monotonic() < until_s:
        if found := answers(session, key):
            return found
    return []


def say(query: zenoh.Query) -> None:
    query.reply(query.key_expr, "answer")


@pytest.mark.parametrize(
    ("user", "password"),
    [("bus-1", "wrong"), ("bus-1", "two"), ("bus-3", "one"), (None, None)],
    ids=["wrong password", "another's password", "unknown user", "no user"],
)
def test_who_does_not_prove_who_it_is_gets_no_session(
    bus: Bus, user: str | None, password: str | None
) -> None:
    with pytest.raises(zenoh.ZError, match="Unable to connect"):
        bus.connect(user, password)


def test_the_right_password_opens_a_session(bus: Bus) -> None:
    """And a vehicle's services hear each other over it."""
    heard = bus.hear(bus.connect("bus-1"), "bus-1", "pose")
    bus.put(bus.connect("bus-1"), "bus-1", "pose", "1")
    assert arrived(heard) == ("bus-1", "1")


def test_sockets_that_say_nothing_keep_nobody_out(bus: Bus) -> None:
    heard = bus.hear(bus.connect("_services"), "*", "pose")
    with contextlib.ExitStack() as stack:
        for _ in range(300):
            stack.enter_context(socket.create_connection(("127.0.0.1", bus.port), timeout=WAIT_S))
        bus.put(bus.connect("bus-1"), "bus-1", "pose", "1")
        assert arrived(heard) == ("bus-1", "1")


def test_the_server_hears_every_vehicle(bus: Bus) -> None:
    heard = bus.hear(bus.connect("_services"), "*", "pose")
    bus.put(bus.connect("bus-1"), "bus-1", "pose", "1")
    assert arrived(heard) == ("bus-1", "1")
    bus.put(bus.connect("bus-2"), "bus-2", "pose", "2")
    assert arrived(heard) == ("bus-2", "2")


def test_what_a_vehicle_puts_under_anothers_key_does_not_arrive(bus: Bus) -> None:
    server, own, thief = (bus.connect(user) for user in ("_services", "bus-2", "bus-1"))
    heard, heard_own = bus.hear(server, "*", "pose"), bus.hear(own, "bus-2", "pose")
    bus.put(thief, "bus-2", "pose", "by an advanced publisher")
    thief.put(message_key("bus-2", "pose", "fusion"), "plain")
    bus.put(thief, "bus-1", "pose", "allowed")
    assert arrived(heard) == ("bus-1", "allowed")
    bus.put(server, "bus-2", "progress", "anything")
    assert heard.empty()
    assert heard_own.empty()


def test_a_vehicle_says_what_its_sensors_say_and_nothing_that_a_server_works_out(bus: Bus) -> None:
    server, vehicle = bus.connect("_services"), bus.connect("bus-1")
    heard = {topic: bus.hear(server, "*", topic) for topic in ("progress", "horizon", "pose")}
    bus.put(vehicle, "bus-1", "progress", "forged")
    bus.put(vehicle, "bus-1", "horizon", "forged")
    vehicle.put(message_key("bus-1", "progress", "fusion"), "forged")
    bus.put(vehicle, "bus-1", "pose", "forged", source="eta")
    bus.put(vehicle, "bus-1", "pose", "own")
    assert arrived(heard["pose"]) == ("bus-1", "own")
    assert all(samples.empty() for samples in heard.values())


def test_a_second_receiver_may_speak(bus: Bus) -> None:
    heard = bus.hear(bus.connect("_services"), "*", "gps_fix")
    bus.put(bus.connect("bus-1"), "bus-1", "gps_fix", "second", source="gps-ingest-2")
    assert arrived(heard) == ("bus-1", "second")


def test_a_forged_sample_in_an_answer_does_not_arrive(bus: Bus) -> None:
    """Readers ask caches for history with any key in the answer, so answers are checked too."""
    server, thief = bus.connect("_services"), bus.connect("bus-1")

    def lie(query: zenoh.Query) -> None:
        query.reply(message_key("bus-2", "pose", "fusion"), "forged")
        query.reply(message_key("bus-1", "pose", "fusion"), "own")

    bus.answer(thief, f"{message_key('bus-1', 'pose', 'fusion')}/@adv/**", lie)
    assert first_answers(server, f"{message_key('*', 'pose', '*')}/@adv/**") == ["own"]


def test_a_vehicle_does_not_hear_another(bus: Bus) -> None:
    server, other, spy = (bus.connect(user) for user in ("_services", "bus-2", "bus-1"))
    bus.put(other, "bus-2", "pose", "kept for late joiners")
    spied = [bus.hear(spy, vehicle_id, "pose") for vehicle_id in ("bus-2", "*")]
    heard, own = bus.hear(server, "bus-2", "pose"), bus.hear(spy, "bus-1", "progress")
    assert arrived(heard) == ("bus-2", "kept for late joiners")
    bus.put(other, "bus-2", "pose", "live")
    assert arrived(heard) == ("bus-2", "live")
    bus.put(server, "bus-1", "progress", "allowed")
    assert arrived(own) == ("bus-1", "allowed")
    assert all(samples.empty() for samples in spied)
    assert answers(spy, f"{message_key('bus-2', 'pose', '*')}/@adv/**") == []


def test_late_joiners_get_the_last_value(bus: Bus) -> None:
    bus.put(bus.connect("bus-1"), "bus-1", "pose", "before")
    for user in ("_services", "_dashboard"):
        assert arrived(bus.hear(bus.connect(user), "*", "pose")) == ("bus-1", "before")


def test_lost_samples_are_recovered(tmp_path: Path) -> None:
    """The router lets two poses a second through; the publisher's cache has the others."""
    bus = Bus(tmp_path)
    two_a_second = {"key_expr": message_key("*", "pose", "*"), "freq": 2.0}
    lossy = {"flows": ["egress"], "messages": ["put"], "rules": [two_a_second]}
    bus.start_router("server.json5", bus.port, downsampling=[lossy])
    heard = bus.hear(bus.connect("_services"), "*", "pose")
    publishers = Publishers(bus.connect("bus-1"))
    received: list[str] = []
    for number in range(100):
        publishers.put("bus-1", "pose", "fusion", str(number).encode())
        with contextlib.suppress(queue.Empty):
            received.append(heard.get(timeout=0.05)[1])
        if len(received) > 10:
            break
    bus.close()
    assert received == [str(number) for number in range(11)]


def test_a_restart_for_another_vehicle_loses_nothing(bus: Bus) -> None:
    heard = bus.hear(bus.connect("_services"), "bus-1", "pose")
    publishers, count = Publishers(bus.connect("bus-1")), itertools.count()

    def drive(seconds: float) -> None:
        for _ in range(round(10.0 * seconds)):
            publishers.put("bus-1", "pose", "fusion", str(next(count)).encode())
            time.sleep(0.1)

    drive(1.0)
    bus.users.write_text(bus.users.read_text() + "tram-7:five\n")
    bus.restart_router("server.json5", access_control=access_control(["bus-1", "bus-2", "tram-7"]))
    drive(3.0)
    received: list[str] = []
    while len(received) < 40:
        received.append(arrived(heard)[1])
    assert received == [str(number) for number in range(40)]
    bus.connect("tram-7", "five")


def test_liveliness_is_seen_and_not_forged(bus: Bus) -> None:
    alive = bus.hear_alive(bus.connect("_dashboard"))
    thief, own, spy = (bus.connect(user) for user in ("bus-1", "bus-2", "bus-1"))
    # a session always hears itself, so it takes another one to listen
    spied = bus.hear_alive(spy)
    heard_other = bus.hear_alive(spy, "bus-2")
    heard = bus.hear_alive(spy, "bus-1")
    bus.live(thief, "bus-2", "fusion")
    bus.live(thief, "bus-1", "fusion")
    assert arrived(alive) == ("bus-1", "SampleKind.PUT")
    bus.live(own, "bus-2", "gps-ingest")
    assert arrived(alive) == ("bus-2", "SampleKind.PUT")
    own.close()  # type: ignore[no-untyped-call]
    assert arrived(alive) == ("bus-2", "SampleKind.DELETE")
    bus.live(thief, "bus-1", "gps-ingest")
    assert [arrived(heard) for _ in range(2)] == [("bus-1", "SampleKind.PUT")] * 2
    assert {arrived(spied)[0] for _ in range(spied.qsize())} <= {"bus-1"}
    assert heard_other.empty()


def test_the_server_publishes_what_it_works_out_and_nothing_else(bus: Bus) -> None:
    server, vehicle = bus.connect("_services"), bus.connect("bus-1")
    dashboard = bus.connect("_dashboard")
    topics = ("pose", "progress", "arrivals", "horizon")
    heard = {topic: bus.hear(dashboard, "*", topic) for topic in topics}
    own = bus.hear(vehicle, "bus-1", "horizon")
    for topic in topics:
        bus.put(server, "bus-1", topic, topic)
    for topic in topics[1:]:
        assert arrived(heard[topic]) == ("bus-1", topic)
    assert arrived(own) == ("bus-1", "horizon")
    assert heard["pose"].empty()


def test_the_dashboard_publishes_its_own_health_only(bus: Bus) -> None:
    server, dashboard = bus.connect("_services"), bus.connect("_dashboard")
    progress, health = bus.hear(server, "*", "progress"), bus.hear(server, FLEET, "health")
    bus.put(dashboard, "bus-1", "progress", "forbidden")
    bus.put(dashboard, FLEET, "health", "forbidden", source="eta")
    bus.put(dashboard, FLEET, "health", "allowed", source="dashboard")
    assert arrived(health) == (FLEET, "allowed")
    assert progress.empty()


def test_a_vehicle_asks_about_itself_and_the_road_only(bus: Bus) -> None:
    server, vehicle = bus.connect("_services"), bus.connect("bus-1")
    for key in (query_key("*", "arrivals"), query_key(FLEET, "lookahead")):
        bus.answer(server, key, say)
    assert first_answers(vehicle, query_key("bus-1", "arrivals")) == ["answer"]
    assert first_answers(vehicle, query_key(FLEET, "lookahead")) == ["answer"]
    assert answers(vehicle, query_key("bus-2", "arrivals")) == []


def test_a_vehicle_behind_its_own_router_has_the_same_rights(bus: Bus) -> None:
    """deploy/zenoh/vehicle.json5: its services talk to their own router, that to the server's."""
    port = free_port()
    server = bus.connect("_services")
    bus.answer(server, query_key("*", "arrivals"), say)
    heard, alive = bus.hear(server, "*", "pose"), bus.hear_alive(server)
    login = {"transport/auth/usrpwd/user": "bus-1", "transport/auth/usrpwd/password": "one"}
    uplink = {"connect/endpoints": [f"tcp/127.0.0.1:{bus.port}"]}
    bus.start_router("vehicle.json5", port, **login, **uplink)
    vehicle = bus.connect("bus-1", port=port)
    bus.live(vehicle, "bus-1", "fusion")
    assert arrived(alive) == ("bus-1", "SampleKind.PUT")
    bus.put(vehicle, "bus-2", "pose", "forged")
    bus.put(vehicle, "bus-1", "pose", "own")
    assert arrived(heard) == ("bus-1", "own")
    own = bus.hear(vehicle, "bus-1", "progress")
    bus.put(server, "bus-1", "progress", "progress")
    assert arrived(own) == ("bus-1", "progress")
    assert first_answers(vehicle, query_key("bus-1", "arrivals")) == ["answer"]
    assert answers(vehicle, query_key("bus-2", "arrivals")) == []
