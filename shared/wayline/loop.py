"""The one main loop: every service's process runs its cores in here.

Zenoh's threads and the feeds only enqueue; one thread takes from the inbox, runs the cores and
publishes. A payload that cannot be read is counted and dropped; an exception in a core is a bug
and ends the process, whose supervisor starts it again.
"""

import contextlib
import logging
import threading
import time
from collections.abc import Iterable
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import AbstractContextManager

import msgspec
import zenoh

from wayline.attendance import Attendance
from wayline.bus import Publishers, Subscription
from wayline.codec import decode, encode
from wayline.condition import Condition
from wayline.ending import Ending
from wayline.host_clock import told_ns
from wayline.http import Healthz
from wayline.inbox import Alive, Inbox, Item, Raw, Sample
from wayline.keys import FLEET, Key, alive_key, parse_alive_key, parse_key
from wayline.messages import Health, Message
from wayline.outbox import Outbox
from wayline.playback import Played
from wayline.queryable import replier
from wayline.receipts import Receipts
from wayline.seats import Seat, Seats
from wayline.service import Feed, Service
from wayline.settings import EVERY_VEHICLE, Settings
from wayline.telemetry import Telemetry
from wayline.view import Receipt

POLL_S = 0.05
HEALTH_S = 1.0
QUIET_S = 30.0
"""A vehicle that is not heard so long has no publishers, whose heartbeats would go on."""

log = logging.getLogger("wayline")


class Loop:
    """A service at work on a session."""

    def __init__(
        self,
        service: Service,
        settings: Settings,
        session: zenoh.Session,
        ending: Ending,
        *,
        inbox: Inbox | None = None,
        telemetry: Telemetry | None = None,
    ) -> None:
        self._service, self._settings, self._session = service, settings, session
        self._ending = ending
        self._ended = threading.Event()
        """Tells the feeds' threads to end; set too when one of them cannot go on."""
        self._feeds: list[Future[None]] = []
        self._inbox = inbox or Inbox()
        self._seats = Seats(service.make_node)
        self._attendance = Attendance()
        self._receipts = Receipts(self._listen_to_health)
        self._telemetry = telemetry or Telemetry(
            service.name, told_ns(), time.monotonic(), recorded=service.is_recorded
        )
        self._condition = Condition(service, settings, session, self._inbox, self._telemetry)
        self._publishers = Publishers(session)
        self._outbox = Outbox(self._publishers.put)
        self._looked_s = time.monotonic()

    def run(self) -> None:
        """Serve until told to stop, then finish what is open.

        Raises what a core raised, and what ended a feed: InputError where it cannot be had.
        """
        with contextlib.ExitStack() as stack:
            self._open(stack)
            next_health_s = time.monotonic()
            while not (self._ending.requested or self._ended.is_set()):
                if self._outbox.is_due or not self._inbox.backlog:
                    self._outbox.send()
                item = self._inbox.get(POLL_S)
                now_s = time.monotonic()
                self._condition.turn(now_s)
                if item is not None:
                    self._take(item, now_s)
                self._let_time_pass(now_s)
                if self._service.store is not None:
                    self._service.store.hand_over()
                if now_s >= next_health_s:
                    next_health_s = now_s + HEALTH_S
                    self._forget_the_silent(now_s)
                    self._tell_health(now_s)
            self._ended.set()
            self._finish()
        self._drain()
        for feed in self._feeds:
            feed.result()

    @property
    def dropped(self) -> int:
        """Messages that came and found the inbox full."""
        return self._inbox.dropped

    @property
    def lost(self) -> int:
        """Samples that the bus lost and could not recover."""
        return self._telemetry.lost_count

    def _open(self, stack: contextlib.ExitStack) -> None:
        service, settings = self._service, self._settings
        served = settings.served()
        if service.store is not None:
            service.store.start(self._ended.set)
            stack.callback(service.store.close)
        for query, answer in service.answers.items():
            queryable = self._session.declare_queryable(query, replier(answer))
            stack.callback(queryable.undeclare)
        stack.callback(self._publishers.close)
        stack.callback(self._outbox.send)
        stack.callback(self._subscribe(served, service.topics).close)
        if Health.topic in service.topics and EVERY_VEHICLE not in served:
            stack.callback(self._subscribe((FLEET,), (Health.topic,)).close)
        stack.callback(self._receipts.close)
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
        if service.is_announced:
            key = alive_key(self._home(), service.name)
            token = self._session.liveliness().declare_token(key)
            stack.callback(token.undeclare)

    def _subscribe(self, vehicle_ids: Iterable[str], topics: Iterable[str]) -> Subscription:
        lost = self._telemetry.lost
        return Subscription(self._session, vehicle_ids, sorted(topics), self._on_sample, lost)

    def _listen_to_health(self, vehicle_id: str) -> AbstractContextManager[object]:
        """A service that reads the health of all has it already."""
        if Health in self._service.reads:
            return contextlib.nullcontext()
        return contextlib.closing(self._subscribe((vehicle_id,), (Health.topic,)))

    def _home(self) -> str:
        """Vehicle part of the service's own keys."""
        served = self._settings.served()
        return served[0] if len(served) == 1 and served[0] != EVERY_VEHICLE else FLEET

    def _on_sample(self, key: str, payload: bytes) -> None:
        self._inbox.put(Sample(key, payload, time.time_ns(), time.monotonic_ns()))

    def _on_alive(self, sample: zenoh.Sample) -> None:
        if (parsed := parse_alive_key(str(sample.key_expr))) is not None:
            up = sample.kind == zenoh.SampleKind.PUT
            self._inbox.put(Alive(*parsed, up))

    def _feed(self, feed: Feed) -> None:
        def put(message: msgspec.Struct, vehicle_id: str | None = None) -> None:
            whose = vehicle_id or self._settings.own_vehicle()
            item = Raw(whose, feed.name, message, time.time_ns(), time.monotonic_ns())
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
            if item.vehicle_id != FLEET:
                self._attendance.hear(item.vehicle_id, now_s)
            self._service.watch_alive(item.vehicle_id, item.service, item.up)

    def _take_sample(self, sample: Sample, now_s: float) -> None:
        if self._service.take_sample is not None:
            self._service.take_sample(sample)
            if not self._service.reads:
                return
        key = parse_key(sample.key)
        message = self._read(key, sample.payload) if key is not None else None
        if key is None or message is None or not self._attendance.admits(key, now_s):
            self._telemetry.bad()
            return
        self._telemetry.heard(key.topic, time.monotonic_ns() - sample.heard_ns)
        if isinstance(message, Health):
            self._receipts.hear(key.vehicle_id, message, key.source)
        if type(message) in self._service.reads:
            if key.vehicle_id != FLEET:
                self._attendance.hear(key.vehicle_id, now_s)
            receipt = self._receipts.note(key.vehicle_id, message, sample)
            if receipt is None:
                self._telemetry.bad()
            else:
                self._hear(key, message, receipt, now_s)

    @staticmethod
    def _read(key: Key, payload: bytes) -> Message | None:
        try:
            return decode(key.topic, payload)
        except msgspec.DecodeError:
            return None

    def _hear(self, key: Key, message: Message, receipt: Receipt, now_s: float) -> None:
        if type(message) in self._service.inputs:
            self._condition.hear(now_s)
        self._show(key.vehicle_id, message, key.source, receipt)
        if key.vehicle_id != FLEET and type(message) in self._service.core_reads:
            seat = self._seats.of(key.vehicle_id)
            seat.hear(message.t_ns, now_s, timeless=type(message) in seat.node.timeless)
            if seat.is_back:
                log.warning("times of %s have gone back, its core starts anew", seat.vehicle_id)
                self._publish(seat, seat.finish())
                seat = self._seats.renew(seat)
                seat.hear(message.t_ns, now_s)
            self._publish(seat, seat.node.take(message, key.source, receipt.age_ns))

    def _take_raw(self, raw: Raw, now_s: float) -> None:
        if isinstance(raw.message, Played):
            self._put(raw.vehicle_id, raw.message.message, raw.message.source)
            return
        self._telemetry.took(time.monotonic_ns() - raw.heard_ns)
        if raw.vehicle_id != self._settings.vehicle_id:
            self._attendance.hear(raw.vehicle_id, now_s)
        seat = self._seats.of(raw.vehicle_id, raw.source)
        seat.hear(raw.received_ns, now_s)
        self._publish(seat, seat.node.give(raw.message, raw.source))

    def _let_time_pass(self, now_s: float) -> None:
        """Now and then look for vehicles that are silent.

        One of which something waits is not: no message is overtaken by the time that it was to
        tell, and a busy inbox does not hide that another vehicle is silent. Where the process is
        to end, what a thousand of them would tell is waited for by nobody.
        """
        if now_s - self._looked_s < POLL_S:
            return
        self._looked_s = now_s
        for seat in self._seats:
            if self._ending.requested:
                return
            if seat.is_due(now_s) and not self._inbox.holds(seat.vehicle_id):
                self._publish(seat, seat.pass_time(now_s))

    def _publish(self, seat: Seat, messages: Iterable[Message]) -> None:
        for message in messages:
            self._put(seat.vehicle_id, message, seat.node.name, seat.node.age_ns)

    def _put(self, vehicle_id: str, message: Message, source: str, age_ns: int = 0) -> None:
        self._outbox.add(vehicle_id, message.topic, source, encode(message))
        self._telemetry.published(message.topic)
        self._show(vehicle_id, message, source, Receipt(time.monotonic_ns(), age_ns))

    def _show(self, vehicle_id: str, message: Message, source: str, receipt: Receipt) -> None:
        for view in self._service.views:
            view.put(vehicle_id, message, source, receipt)

    def _forget_the_silent(self, now_s: float) -> None:
        """Vehicles that nobody named have a seat as long as they are heard."""
        if EVERY_VEHICLE not in self._settings.served():
            return
        self._outbox.send()  # whose publishers are forgotten has said all
        for vehicle_id in self._attendance.silent(now_s - QUIET_S):
            self._publishers.forget(vehicle_id)
        for vehicle_id in self._attendance.leave(now_s - self._settings.forget_vehicle_after_s):
            for seat in self._seats.leave(vehicle_id):
                self._publish(seat, seat.finish())
            self._outbox.send()
            self._publishers.forget(vehicle_id)
            self._receipts.forget(vehicle_id)
            for view in self._service.views:
                view.forget(vehicle_id)

    def _tell_health(self, now_s: float) -> None:
        health = self._condition.look(now_s)
        if self._service.is_announced:
            self._publishers.put(self._home(), health.topic, self._service.name, encode(health))
            self._show(self._home(), health, self._service.name, Receipt(time.monotonic_ns()))

    def healthz(self) -> Healthz:
        """What the probes answer."""
        return self._condition.healthz()

    def _drain(self) -> None:
        """Hand over what came before the end to whoever wants every sample."""
        while self._service.take_sample is not None and self._inbox.backlog:
            if isinstance(item := self._inbox.get(0.0), Sample):
                self._service.take_sample(item)

    def _finish(self) -> None:
        """Tell every core that input has ended, so that nothing learned is lost."""
        for seat in self._seats:
            self._publish(seat, seat.finish())
