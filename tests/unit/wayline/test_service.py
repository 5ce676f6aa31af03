"""The one loop: what it hears, counts, publishes, and how it ends.

The session is a real one that reaches nobody but itself.
"""

import queue
import threading
import time
from collections.abc import Callable, Sequence

import msgspec
import pytest
import zenoh

from builders import at, fix, gyro
from echoing import ALL, ONE, Bug, Echo, echo
from loops import WAIT_S, Run, Running
from wayline.bus import Subscription
from wayline.core import Record
from wayline.errors import InputError
from wayline.inbox import Inbox, Item
from wayline.inputs import Sentence, Tick
from wayline.keys import FLEET, message_key
from wayline.messages import GpsFix, Gyro, Message, Odometer
from wayline.node import Node
from wayline.playback import Played
from wayline.service import Service


class Given:
    """A feed that does what the test says."""

    name = "echo-2"
    detail = "given"
    problem: str | None = None

    def __init__(
        self, run: Callable[[Callable[[msgspec.Struct], None]], None], *, can_wait: bool = True
    ) -> None:
        self._run = run
        self.can_wait = can_wait

    def run(self, put: Callable[[msgspec.Struct], None], stop: threading.Event) -> None:
        self._run(put)


def speeds(running: Running) -> list[tuple[int, float | None]]:
    found = [heard.message for heard in running.listener.heard("odometer")]
    return [(m.t_ns, m.speed_mps) for m in found if isinstance(m, Odometer)]


def test_what_is_heard_goes_through_the_core_onto_the_bus_with_its_ticks(run: Run) -> None:
    running = run(echo(), ONE)
    running.await_start()
    running.put(fix(0.05, 55.0, 10.0))
    running.put(fix(0.2, 55.0, 10.0))
    running.await_odometer(at(0.2), 2.0)
    assert speeds(running) == [(at(0.05), 1.0), (at(0.1), 2.0), (at(0.2), 1.0), (at(0.2), 2.0)]
    assert {heard.source for heard in running.listener.heard("odometer")} == {"echo"}


def test_in_silence_time_goes_on_by_the_clock_on_the_same_grid(run: Run) -> None:
    running = run(echo(), ONE)
    running.await_start()
    heard_s = time.monotonic()
    running.put(fix(0.05, 55.0, 10.0))
    first = running.listener.await_message(
        "odometer", lambda h: h.message == Odometer(t_ns=at(0.1), speed_mps=2.0), timeout_s=WAIT_S
    )
    assert 0.9 < first.received_s - heard_s < 1.5
    running.await_odometer(at(1.5), 2.0)
    assert speeds(running)[1:16] == [(at(tenth / 10), 2.0) for tenth in range(1, 16)]
    # ticks do not run ahead of the clock
    assert time.monotonic() - heard_s > 1.4


def test_a_silent_vehicle_is_noticed_though_another_one_talks_without_a_pause(run: Run) -> None:
    running = run(echo(), ALL)
    running.await_start()
    running.put(fix(0.05, 55.0, 10.0), "bus-8")
    deadline_s, number = time.monotonic() + 5.0, 0
    wanted = Odometer(t_ns=at(0.1), speed_mps=2.0)
    while time.monotonic() < deadline_s:
        number += 1
        # older than the one before, so that this vehicle has no ticks of its own
        running.put(fix(-number, 55.0, 10.0), "bus-7")
        if any(heard.message == wanted for heard in running.listener.heard("odometer")):
            return
        running.await_odometer(at(-number), 1.0)
    raise AssertionError("the silent vehicle had no tick in 5 s")


def test_time_does_not_overtake_messages_that_wait(run: Run) -> None:
    blocked, go, forever = threading.Event(), threading.Event(), threading.Event()

    class Slow(Echo):
        def handle(self, message: msgspec.Struct, source: str) -> Sequence[Message | Record]:
            if isinstance(message, GpsFix) and message.t_ns >= at(10):
                blocked.set()
                assert go.wait(WAIT_S)
                # longer than the loop takes between two looks for silence
                assert not forever.wait(0.1)
            return super().handle(message, source)

    running = run(Service("echo", lambda *_: Node("echo", Slow()), Echo.reads), ALL)
    running.await_start()
    running.put(fix(0.05, 55.0, 10.0), "bus-8")
    running.await_odometer(at(0.05), 1.0)
    running.put(fix(10, 55.0, 10.0), "bus-7")
    assert blocked.wait(WAIT_S)
    # these wait behind a core that takes longer than the silence that lets time pass
    running.put(fix(10.05, 55.0, 10.0), "bus-7")
    running.put(fix(10.06, 55.0, 10.0), "bus-7")
    running.put(fix(0.15, 55.0, 10.0), "bus-8")
    assert not go.wait(1.2)
    go.set()
    running.await_odometer(at(0.15), 1.0)
    of_bus_8 = [each for each in speeds(running) if each[0] < at(5)]
    assert of_bus_8[:3] == [(at(0.05), 1.0), (at(0.1), 2.0), (at(0.15), 1.0)]


@pytest.mark.parametrize("payload", [b"{", b"\xff", b"[]", b'{"t_ns":1,"valid":7}'])
def test_a_payload_that_cannot_be_read_is_counted_and_dropped(run: Run, payload: bytes) -> None:
    running = run(echo(), ONE)
    running.await_start()
    running.put_payload(payload, "gps_fix")
    assert running.await_health(lambda health: health.bad_input > 0).bad_input == 1
    running.put(fix(0.05, 55.0, 10.0))
    running.await_odometer(at(0.05), 1.0)


def test_the_lag_of_a_recording_is_not_its_age(run: Run) -> None:
    running = run(echo(), ONE)
    running.await_start()
    running.put(fix(0.05, 55.0, 10.0))
    health = running.await_health(lambda health: health.lag_ms_p99 is not None)
    assert health.lag_ms_p99 is not None
    assert 0.0 < health.lag_ms_p99 < 1_000.0


def test_when_older_times_go_on_after_wrong_ones_so_do_the_ticks(run: Run) -> None:
    running = run(echo(), ONE)
    running.await_start()
    for second in range(3):
        running.put(fix(50.0 + second, 55.0, 10.0))
    good_s, tenth = time.monotonic(), 0
    while not any(t_ns < at(49) and speed == 2.0 for t_ns, speed in speeds(running)):
        tenth += 1
        running.put(fix(tenth / 10 - 0.05, 55.0, 10.0))
        assert time.monotonic() - good_s < 5.0
        time.sleep(0.1)


def test_an_old_message_and_one_that_comes_twice_bring_no_ticks(run: Run) -> None:
    running = run(echo(), ONE)
    running.await_start()
    for seconds in (0.05, 0.15, 0.15, 0.05, 0.25):
        running.put(fix(seconds, 55.0, 10.0))
    running.await_odometer(at(0.25), 1.0)
    assert [t_ns for t_ns, speed in speeds(running) if speed == 2.0] == [at(0.1), at(0.2)]


def fix_now() -> GpsFix:
    """A fix so fresh that nobody asks whether its vehicle is a recording."""
    return msgspec.structs.replace(fix(0, 55.0, 10.0), t_ns=time.time_ns())


def test_a_busy_loop_sends_what_it_says_while_more_waits(run: Run) -> None:
    """A fix is answered while the next one is worked on for a second, and forty more wait."""
    said = threading.Event()

    class Slow(Echo):
        def handle(self, message: msgspec.Struct, source: str) -> Sequence[Message | Record]:
            if isinstance(message, GpsFix):
                if message.t_ns > at(0.5):
                    assert said.wait(WAIT_S)
                time.sleep(0.01)
            return super().handle(message, source)

    running = run(Service("echo", lambda *_: Node("echo", Slow()), Echo.reads), ONE)
    running.await_start()
    for tenth in range(40):
        running.put(fix(tenth / 10, 55.0, 10.0))
    running.await_odometer(at(0.4), 1.0)
    said.set()
    running.await_odometer(at(3.9), 1.0)


def test_an_end_does_not_wait_for_the_time_of_a_silent_fleet(run: Run) -> None:
    """It is asked for while the first of fifty vehicles is told that time has passed."""
    begun, go = threading.Event(), threading.Event()
    told: list[str] = []

    class Patient(Echo):
        def __init__(self, vehicle_id: str) -> None:
            self._vehicle_id = vehicle_id

        def handle(self, message: msgspec.Struct, source: str) -> Sequence[Message | Record]:
            if isinstance(message, Tick):
                told.append(self._vehicle_id)
                begun.set()
                assert go.wait(WAIT_S)
            return super().handle(message, source)

    service = Service("echo", lambda vehicle_id, _: Node("echo", Patient(vehicle_id)), Echo.reads)
    running = run(service, ALL)
    running.await_start()
    for number in range(50):
        running.put(fix(0.05, 55.0, 10.0), f"bus-{number}")
    assert begun.wait(WAIT_S)
    running.request_end()
    go.set()
    running.end()
    assert len(set(told)) == 1


def test_what_a_full_inbox_drops_is_counted_in_health(
    run: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("wayline.inbox.Inbox.__init__.__defaults__", (5,))
    blocked, go, arrived = threading.Event(), threading.Event(), threading.Semaphore(0)
    put = Inbox.put

    def put_and_tell(inbox: Inbox, item: Item) -> None:
        put(inbox, item)
        arrived.release()

    monkeypatch.setattr(Inbox, "put", put_and_tell)

    class Slow(Echo):
        def handle(self, message: msgspec.Struct, source: str) -> Sequence[Message | Record]:
            blocked.set()
            assert go.wait(WAIT_S)
            return ()

    running = run(Service("echo", lambda *_: Node("echo", Slow()), Echo.reads), ONE)
    running.await_start()
    running.put(fix_now())
    assert blocked.wait(WAIT_S)
    for _ in range(12):
        running.put(fix_now())
    assert all(arrived.acquire(timeout=WAIT_S) for _ in range(1 + 12))
    go.set()
    assert running.await_health(lambda health: health.dropped > 0).dropped == 7


def test_a_feed_reaches_its_own_core_and_a_recording_the_bus(run: Run) -> None:
    def feed(put: Callable[[msgspec.Struct], None]) -> None:
        put(Sentence(None, "$GPGGA"))
        put(Played("can-ingest", gyro(5, 1.5)))

    running = run(echo(Given(feed)), ONE)
    running.await_odometer(at(0), 3.0)
    heard = running.listener.await_message("gyro", timeout_s=WAIT_S)
    assert (heard.source, heard.message) == ("can-ingest", gyro(5, 1.5))
    assert {each.source for each in running.listener.heard("odometer")} == {"echo-2"}
    # a feed that is done leaves the service at work
    assert running.await_health(lambda health: health.in_rate_hz == 0.0).detail == "given"


def test_a_live_feed_never_waits_and_what_it_loses_is_counted(
    run: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A receiver's thread goes on reading while a core is busy and the inbox full."""
    monkeypatch.setattr("wayline.inbox.Inbox.__init__.__defaults__", (5,))
    blocked, go = threading.Event(), threading.Event()

    class Slow(Echo):
        def handle(self, message: msgspec.Struct, source: str) -> Sequence[Message | Record]:
            blocked.set()
            assert go.wait(WAIT_S)
            return ()

    def feed(put: Callable[[msgspec.Struct], None]) -> None:
        put(Sentence(None, "$GPGGA"))
        assert blocked.wait(WAIT_S)
        for _ in range(12):
            put(Sentence(None, "$GPGGA"))
        go.set()

    service = Service("echo", lambda *_: Node("echo", Slow()), feeds=[Given(feed, can_wait=False)])
    assert run(service, ONE).await_health(lambda health: health.dropped > 0).dropped == 7


def test_a_feed_that_cannot_go_on_ends_the_service_with_its_reason(run: Run) -> None:
    def feed(put: Callable[[msgspec.Struct], None]) -> None:
        raise InputError("can0", "no such interface", "ip link set can0 up")

    with pytest.raises(InputError, match="can0: no such interface"):
        run(echo(Given(feed)), ONE).result()


def test_a_bug_in_a_feed_ends_the_service_loudly(run: Run) -> None:
    def feed(put: Callable[[msgspec.Struct], None]) -> None:
        raise ZeroDivisionError("a bug in the feed")

    with pytest.raises(ZeroDivisionError, match="in the feed"):
        run(echo(Given(feed)), ONE).result()


def test_a_bug_in_a_core_ends_the_service_loudly(run: Run) -> None:
    running = run(Service("echo", lambda *_: Node("echo", Bug()), Bug.reads), ONE)
    running.await_start()
    running.put(fix(0, 55.0, 10.0))
    with pytest.raises(ZeroDivisionError, match="in the core"):
        running.result()


def test_the_end_finishes_what_is_open_and_takes_the_token_away(run: Run) -> None:
    running = run(echo(), ONE)
    running.await_start()
    running.listener.await_alive("echo", timeout_s=WAIT_S)
    running.put(fix(0.05, 55.0, 10.0))
    running.await_odometer(at(0.05), 1.0)
    running.end()
    running.await_odometer(at(0.05), 4.0)
    running.listener.await_alive("echo", up=False, timeout_s=WAIT_S)


def test_a_fleet_service_has_a_core_a_vehicle_and_ignores_fleet_messages(
    run: Run, session: zenoh.Session
) -> None:
    keys: queue.SimpleQueue[str] = queue.SimpleQueue()
    made: list[str] = []

    def make_node(vehicle_id: str, source: str) -> Node:
        made.append(vehicle_id)
        return Node("echo", Echo())

    running = run(Service("echo", make_node, frozenset({GpsFix, Gyro})), ALL)
    running.await_start()
    heard = Subscription(session, ["*"], ["odometer"], lambda key, _: keys.put(key))
    for vehicle_id in (FLEET, "bus-7", "bus-8", "bus-7"):
        running.put(fix(0.05, 55.0, 10.0), vehicle_id)
    found = {keys.get(timeout=WAIT_S) for _ in range(3)}
    heard.close()
    assert made == ["bus-7", "bus-8"]
    assert found == {message_key(each, "odometer", "echo") for each in made}


def test_health_is_heard_under_the_one_vehicle_served_or_the_fleet(
    run: Run, session: zenoh.Session
) -> None:
    keys: queue.SimpleQueue[str] = queue.SimpleQueue()
    heard = Subscription(session, ["*"], ["health"], lambda key, _: keys.put(key))
    run(echo(), ONE)
    assert keys.get(timeout=WAIT_S) == message_key("bus-7", "health", "echo")
    heard.close()
