"""A live can-ingest on a bus at full load: CPU, losses, and how late its messages are."""

import contextlib
import multiprocessing
import sys
import tempfile
import time
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path

import can
import numpy as np
import zenoh

from wayline.bus import Subscription, open_session
from wayline.codec import decode, encode
from wayline.keys import parse_key
from wayline.messages import Gyro, Health, Message, Odometer, Torque
from wayline_bench import bare_bus, echo
from wayline_bench.bus_feeder import BusFeed, Fed, feed
from wayline_bench.made_up_bus import DBC, MAPPED_IDS, MAPPING, RATE_HZ, frame
from wayline_bench.rounds import Say
from wayline_bench.row import Row, compared
from wayline_cli.local_system import LocalSystem, free_ports

SERVICE = "can-ingest"
GROUP = "239.74.163.3"
START_S = 20.0
ASK_S = 0.05
ROUNDS = 8
ROUND_S = 1.5
CORE_SHARE_BAR = 0.25
TABLE = """[[can]]
interface = "udp_multicast"
channel = "{group}"
options = {{ port = {port}, hop_limit = 0 }}
dbc = ["bench.dbc"]
"""
TOPICS = (Odometer, Gyro, Torque)


@dataclass(frozen=True)
class Ears:
    """What was heard when (monotonic clock); decoded when all is over."""

    messages: list[tuple[str, bytes, float]] = field(default_factory=list)
    """Key and payload."""
    answers: list[tuple[bytes, float]] = field(default_factory=list)

    def on_message(self, key: str, payload: bytes) -> None:
        """A message came."""
        self.messages.append((key, payload, time.monotonic()))

    def on_answer(self, sample: zenoh.Sample) -> None:
        """The echo came back."""
        self.answers.append((sample.payload.to_bytes(), time.monotonic()))

    def decoded(self) -> list[tuple[Message, float]]:
        """What was heard of the service."""
        keys = ((parse_key(key), payload, at_s) for key, payload, at_s in self.messages)
        return [(decode(key.topic, text), at_s) for key, text, at_s in keys if key is not None]


def bus_rows(say: Say) -> list[Row]:
    """A bus of which a tenth is mapped, and one of which every frame is."""
    if not is_multicast_there():
        print("the live bus is left out: no multicast on this machine", file=sys.stderr)
        return []
    kinds = {"1 in 10 mapped": False, "all mapped": True}
    return [
        row
        for kind, only_mapped in kinds.items()
        for row in _lived(f"{RATE_HZ} frames/s live, {kind}", only_mapped, say)
    ]


def is_multicast_there() -> bool:
    """Whether a datagram goes from one socket of a group to another."""
    (port,) = free_ports(1)
    try:
        with bare_bus.open_bus(GROUP, port) as one, bare_bus.open_bus(GROUP, port) as other:
            one.send(frame(0, 0))
            return other.recv(2.0) is not None
    except (can.CanError, OSError):
        return False


def _lived(name: str, only_mapped: bool, say: Say) -> list[Row]:
    say(f"{name}: {ROUNDS} rounds of {ROUND_S:g} s, the echo between them")
    ears = Ears()
    fed = _run(ears, only_mapped=only_mapped)
    heard = ears.decoded()
    sent = sum(fed.mapped.values())
    told = {
        int(message.distance_m): at_s
        for message, at_s in heard
        if isinstance(message, Odometer) and message.distance_m is not None
    }
    arrived = sum(not isinstance(message, Health) for message, _ in heard)
    dropped = max(message.dropped for message, _ in heard if isinstance(message, Health))
    answered = {int(payload): at_s for payload, at_s in ears.answers}
    ours_ms = [1e3 * (told[n] - at_s) for n, at_s in fed.sent_s.items() if n in told]
    echo_ms = [1e3 * (answered[n] - at_s) for n, at_s in fed.echo_sent_s.items() if n in answered]
    shares, bare = fed.shares[SERVICE], fed.shares[bare_bus.__name__]
    cores = [1.0] * len(shares)
    return [
        compared(f"{name}: CPU", shares, cores, "core", bar=CORE_SHARE_BAR),
        compared(f"{name}: CPU", shares, bare, "core, bare python-can"),
        compared(f"{name}: lost messages", [float(sent - arrived)], [float(sent)], "sent", bar=0.0),
        compared(f"{name}: dropped by itself", [float(dropped)], [float(sent)], "sent", bar=0.0),
        *(_latency(f"{name}: frame to bus", ours_ms, echo_ms, percent) for percent in (50, 99)),
    ]


def _latency(what: str, ours_ms: Sequence[float], echo_ms: Sequence[float], percent: int) -> Row:
    ours, bare = (float(np.percentile(each, percent)) for each in (ours_ms, echo_ms))
    return compared(f"{what}, p{percent}", [ours], [bare], "bare Zenoh echo", unit="ms")


def _run(ears: Ears, *, only_mapped: bool) -> Fed:
    """Run the processes and feed them. Raises TimeoutError where one does not start."""
    (port,) = free_ports(1)
    with contextlib.ExitStack() as stack:
        folder = Path(stack.enter_context(tempfile.TemporaryDirectory(prefix="wayline-bench-")))
        system = stack.enter_context(LocalSystem(folder, vehicle_id="bench"))
        _start(system, port)
        session = stack.enter_context(open_session(system.bus))
        topics = [each.topic for each in (*TOPICS, Health)]
        subscription = Subscription(session, ["bench"], topics, ears.on_message)
        stack.callback(subscription.close)
        answers = session.declare_subscriber(echo.ANSWER, ears.on_answer)
        stack.callback(answers.undeclare)
        _await_hearing(ears, port)
        pids = {name: system.pid(name) for name in (SERVICE, bare_bus.__name__)}
        size = len(encode(Odometer(t_ns=time.time_ns(), distance_m=1234.0)))
        plan = BusFeed(GROUP, port, pids, system.bus, only_mapped, ROUNDS, ROUND_S, size)
        # not forked: Zenoh's threads would not come along
        spawn = multiprocessing.get_context("spawn")
        fed = stack.enter_context(ProcessPoolExecutor(1, spawn)).submit(feed, plan).result()
        # the next health tells of all drops
        _await_health(ears, time.monotonic())
    return fed


def _start(system: LocalSystem, port: int) -> None:
    """Router, echo, can-ingest and the bare reader."""
    (system.folder / "bench.dbc").write_text(DBC)
    with system.config.open("a") as config:
        config.write(TABLE.format(group=GROUP, port=port) + MAPPING)
    system.start_router()
    (endpoint,) = system.bus.connect
    system.start_command("echo", (sys.executable, "-m", echo.__name__, endpoint))
    name = bare_bus.__name__
    system.start_command(name, (sys.executable, "-m", name, GROUP, str(port)))
    system.await_said("echo", echo.READY, START_S)
    system.await_said(name, bare_bus.READY, START_S)
    system.start(SERVICE)


def _await_hearing(ears: Ears, port: int) -> None:
    """Send frames until the service speaks, then forget what it said."""
    topics = {each.topic for each in TOPICS}
    deadline_s = time.monotonic() + START_S
    with bare_bus.open_bus(GROUP, port) as bus:
        while not any(key.split("/")[3] in topics for key, _, _ in ears.messages):
            if time.monotonic() > deadline_s:
                raise TimeoutError(f"{SERVICE} is not heard")
            bus.send(frame(MAPPED_IDS[0], 0))
            time.sleep(ASK_S)
    _await_health(ears, time.monotonic())
    ears.messages.clear()


def _await_health(ears: Ears, since_s: float) -> None:
    """Wait for a health that was said later than some instant."""
    deadline_s = time.monotonic() + START_S
    while not any(
        at_s > since_s and key.split("/")[3] == Health.topic for key, _, at_s in ears.messages
    ):
        if time.monotonic() > deadline_s:
            raise TimeoutError(f"{SERVICE} tells no health")
        time.sleep(ASK_S)
