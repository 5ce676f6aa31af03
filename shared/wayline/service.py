"""The one main loop: every service's process runs its cores in here.

Zenoh's threads and the feeds only enqueue; one thread takes from the inbox, runs the cores and
publishes. A payload that cannot be read is counted and dropped; an exception in a core is a bug
and ends the process, whose supervisor starts it again.
"""

import contextlib
import logging
import threading
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass, field
from typing import Any, Protocol

import msgspec
import zenoh

from wayline import __version__
from wayline.bus import Publishers, Subscription, open_session
from wayline.codec import decode, encode
from wayline.http import Healthz
from wayline.http_server import HttpServer
from wayline.inbox import Alive, Inbox, Item, Raw, Sample
from wayline.inputs import Tick
from wayline.keys import FLEET, alive_key, parse_key
from wayline.messages import Health, Message
from wayline.node import Node
from wayline.playback import Played
from wayline.queryable import Answer, replier
from wayline.settings import EVERY_VEHICLE, Settings
from wayline.stop import Stop, stop_on_signals, unless_stopped
from wayline.telemetry import Telemetry

IDLE_S = 1.0
"""Without input this long, time is advanced by the monotonic clock (SPEC section 2)."""
POLL_S = 0.05
HEALTH_S = 1.0
STUCK_S = 10.0
"""A loop that has not turned this long is not well."""

log = logging.getLogger("wayline")


Watch = Callable[[str, Message, str], None]
"""Told a message with its vehicle and source."""


class Feed(Protocol):
    """A source of raw input: a receiver, an interface, a recording. Runs in a thread of its own."""

    name: str
    """Becomes the `source` of what it gives."""
    can_wait: bool
    """A recording waits for room in the inbox; what a live source says without room is dropped."""

    def run(self, put: Callable[[msgspec.Struct], None], stop: threading.Event) -> None:
        """Put inputs until told to stop; come back by itself when the device does."""
        ...

    @property
    def detail(self) -> str | None:
        """What `health` should say of it."""
        ...


def no_core(vehicle_id: str, source: str) -> Node:
    """For a service whose feeds give ready messages: a recording is translated as it is paced."""
    raise AssertionError(f"there is no core for input of {vehicle_id} from {source}")


@dataclass(slots=True)
class Service:
    """What a shell hands over."""

    name: str
    make_node: Callable[[str, str], Node] = no_core
    """A core with its store for a vehicle (and, for raw input, a source)."""
    reads: frozenset[type[Message]] = frozenset()
    watch: Watch | None = None
    """Told every message heard and published, with its vehicle and source."""
    watch_alive: Callable[[str, str, bool], None] | None = None
    """Told of services that come and go, with their vehicle."""
    make_app: Callable[[Callable[[], Healthz], Telemetry], Any] | None = None
    answers: Mapping[str, Answer] = field(default_factory=dict)
    """By the key of the queryable."""
    feeds: Sequence[Feed] = ()
    bad_input: Callable[[], int] = lambda: 0
    """What the cores and feeds have counted and dropped."""


def run(service: Service, settings: Settings) -> None:
    """Run a service until SIGTERM or Ctrl-C. Raises InputError for bad configuration."""
    logging.basicConfig(level=logging.INFO, format="%(asctime)s %(name)s %(message)s")
    logging.getLogger("uvicorn").setLevel(logging.WARNING)
    with stop_on_signals() as stop:
        session = unless_stopped(
            lambda: open_session(settings.bus),
            stop,
            patience_s=1.0,
            waiting=lambda: log.info("waiting for a router at %s", ", ".join(settings.bus.connect)),
        )
        if session is None:
            return
        with session:
            log.info("%s %s started", service.name, __version__)
            Loop(service, settings, session, stop).run()
    log.info("%s stopped", service.name)


@dataclass(slots=True)
class Seat:
    """One core at work, and how far its time has come."""

    vehicle_id: str
    node: Node
    last_ns: int = 0
    heard_s: float = 0.0


class Loop:
    """A service at work on a session."""

    def __init__(
        self,
        service: Service,
        settings: Settings,
        session: zenoh.Session,
        stop: Stop,
    ) -> None:
        self._service, self._settings, self._session = service, settings, session
        self._stop = stop
        self._ended = threading.Event()
        """Tells the feeds' threads to end; set too when one of them cannot go on."""
        self._feeds: list[Future[None]] = []
        self._inbox = Inbox()
        self._seats: dict[tuple[str, str], Seat] = {}
        self._telemetry = Telemetry(service.name, time.time_ns())
        self._publishers = Publishers(session)
        self._turned_s = self._as_of_s = time.monotonic()
        self._ahead = 0
        """How many items are still to be taken of those that waited at `_as_of_s`."""
        self._health: Health | None = None
        self._last_drop_count = 0

    def run(self) -> None:
        """Serve until told to stop, then finish what is open.

        Raises what a core raised, and what ended a feed: InputError where it cannot be had.
        """
        with contextlib.ExitStack() as stack:
            self._open(stack)
            next_health_s = time.monotonic()
            while not (self._stop.requested or self._ended.is_set()):
                item = self._inbox.get(POLL_S)
                now_s = self._turned_s = time.monotonic()
                if item is not None:
                    self._take(item, now_s)
                    self._ahead -= 1
                self._let_time_pass(now_s)
                if now_s >= next_health_s:
                    next_health_s = now_s + HEALTH_S
                    self._publish_health()
            self._ended.set()
            self._finish()
        for feed in self._feeds:
            feed.result()

    def _open(self, stack: contextlib.ExitStack) -> None:
        service, settings = self._service, self._settings
        served = settings.served()
        if service.make_app is not None:
            app = service.make_app(self.healthz, self._telemetry)
            server = HttpServer(app, settings.http_of(service.name))
            server.start()
            stack.callback(server.stop)
            log.info("%s answers on %s", service.name, server.url)
        for query, answer in service.answers.items():
            queryable = self._session.declare_queryable(query, replier(answer))
            stack.callback(queryable.undeclare)
        stack.callback(self._publishers.close)
        self._subscribe(stack, served, service.reads)
        if Health in service.reads and EVERY_VEHICLE not in served:
            self._subscribe(stack, (FLEET,), (Health,))
        if service.watch_alive is not None:
            alive = self._session.liveliness().declare_subscriber(
                alive_key("*", "*"), self._on_alive, history=True
            )
            stack.callback(alive.undeclare)
        if service.feeds:
            threads = stack.enter_context(ThreadPoolExecutor(len(service.feeds), "feed"))
            stack.callback(self._ended.set)
            self._feeds = [threads.submit(self._feed, feed) for feed in service.feeds]
            for running in self._feeds:
                running.add_done_callback(self._end_if_failed)
        token = self._session.liveliness().declare_token(alive_key(self._home(), service.name))
        stack.callback(token.undeclare)

    def _subscribe(
        self,
        stack: contextlib.ExitStack,
        vehicle_ids: Iterable[str],
        reads: Iterable[type[Message]],
    ) -> None:
        topics = sorted(message.topic for message in reads)
        lost = self._telemetry.lost
        subscription = Subscription(self._session, vehicle_ids, topics, self._on_sample, lost)
        stack.callback(subscription.close)

    def _home(self) -> str:
        """Vehicle part of the service's own keys."""
        served = self._settings.served()
        return served[0] if len(served) == 1 and served[0] != EVERY_VEHICLE else FLEET

    def _on_sample(self, key: str, payload: bytes) -> None:
        self._inbox.put(Sample(key, payload, time.time_ns()))

    def _on_alive(self, sample: zenoh.Sample) -> None:
        parts = str(sample.key_expr).split("/")
        up = sample.kind == zenoh.SampleKind.PUT
        self._inbox.put(Alive(parts[2], parts[4], up))

    def _feed(self, feed: Feed) -> None:
        vehicle_id = self._settings.own_vehicle()

        def put(message: msgspec.Struct) -> None:
            item = Raw(vehicle_id, feed.name, message, time.time_ns())
            if not feed.can_wait:
                self._inbox.put(item)
                return
            while not self._inbox.put_waiting(item, POLL_S) and not self._ended.is_set():
                pass

        feed.run(put, self._ended)

    def _end_if_failed(self, feed: Future[None]) -> None:
        if feed.exception() is not None:
            self._ended.set()

    def _take(self, item: Item, now_s: float) -> None:
        if isinstance(item, Sample):
            self._take_sample(item, now_s)
        elif isinstance(item, Raw):
            self._take_raw(item, now_s)
        elif self._service.watch_alive is not None:
            self._service.watch_alive(item.vehicle_id, item.service, item.up)

    def _take_sample(self, sample: Sample, now_s: float) -> None:
        key = parse_key(sample.key)
        if key is None:
            self._telemetry.bad()
            return
        try:
            message = decode(key.topic, sample.payload)
        except msgspec.DecodeError:
            self._telemetry.bad()
            return
        self._telemetry.heard(key.topic, message.t_ns, sample.received_ns)
        self._watch(key.vehicle_id, message, key.source)
        if key.vehicle_id == FLEET:
            return
        seat = self._seat(key.vehicle_id, "")
        self._hear(seat, message.t_ns, now_s)
        self._publish(seat, seat.node.take(message, key.source))

    def _take_raw(self, raw: Raw, now_s: float) -> None:
        if isinstance(raw.message, Played):
            self._put(raw.vehicle_id, raw.message.message, raw.message.source)
            return
        self._telemetry.took()
        seat = self._seat(raw.vehicle_id, raw.source)
        self._hear(seat, raw.received_ns, now_s)
        self._publish(seat, seat.node.give(raw.message, raw.source))

    def _hear(self, seat: Seat, t_ns: int, now_s: float) -> None:
        seat.last_ns, seat.heard_s = max(seat.last_ns, t_ns), now_s

    def _seat(self, vehicle_id: str, source: str) -> Seat:
        seat = self._seats.get((vehicle_id, source))
        if seat is None:
            seat = Seat(vehicle_id, self._service.make_node(vehicle_id, source))
            self._seats[vehicle_id, source] = seat
        return seat

    def _let_time_pass(self, now_s: float) -> None:
        """Now and then look for silence, as of an instant whose items have all been taken.

        So a busy inbox does not hide that one vehicle is silent, and a message that waits in it
        is not overtaken by the time that it was to tell.
        """
        if self._ahead > 0 or now_s - self._as_of_s < POLL_S:
            return
        self._idle(self._as_of_s)
        self._as_of_s, self._ahead = now_s, self._inbox.backlog

    def _idle(self, now_s: float) -> None:
        """Let time pass where nothing has come for a while."""
        for (_, source), seat in self._seats.items():
            silent_s = now_s - seat.heard_s
            if silent_s < IDLE_S:
                continue
            t_ns = seat.last_ns + round(silent_s * 1e9)
            if source:
                self._publish(seat, seat.node.give(Tick(t_ns), source))
            else:
                self._publish(seat, seat.node.advance(t_ns))

    def _publish(self, seat: Seat, messages: Iterable[Message]) -> None:
        for message in messages:
            self._put(seat.vehicle_id, message, seat.node.name)

    def _put(self, vehicle_id: str, message: Message, source: str) -> None:
        self._publishers.put(vehicle_id, message.topic, source, encode(message))
        self._telemetry.published(message.topic)
        self._watch(vehicle_id, message, source)

    def _watch(self, vehicle_id: str, message: Message, source: str) -> None:
        if self._service.watch is not None:
            self._service.watch(vehicle_id, message, source)

    def _publish_health(self) -> None:
        service, inbox = self._service, self._inbox
        details = [feed.detail for feed in service.feeds if feed.detail]
        self._health = self._telemetry.health(
            time.time_ns(),
            inbox.backlog,
            inbox.dropped,
            service.bad_input(),
            "; ".join(details) or None,
        )
        self._publishers.put(self._home(), self._health.topic, service.name, encode(self._health))
        self._watch(self._home(), self._health, service.name)
        if self._health.dropped > self._last_drop_count:
            log.warning("%d messages dropped so far", self._health.dropped)
            self._last_drop_count = self._health.dropped

    def healthz(self) -> Healthz:
        """What /healthz answers: well while the loop turns."""
        stuck_s = time.monotonic() - self._turned_s
        return Healthz(
            ok=stuck_s < STUCK_S,
            service=self._service.name,
            version=__version__,
            detail=None if stuck_s < STUCK_S else f"the loop has not turned for {stuck_s:.0f} s",
            health=self._health,
        )

    def _finish(self) -> None:
        """Tell every core that input has ended, so that nothing learned is lost."""
        for seat in self._seats.values():
            self._publish(seat, seat.node.finish(seat.last_ns))
