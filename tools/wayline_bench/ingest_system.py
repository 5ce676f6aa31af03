"""Real gps-ingest processes with a router, a feeder, an echo and a listener around them."""

import contextlib
import json
import multiprocessing
import sys
import tempfile
import time
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple

import psutil
import zenoh

from wayline.bus import Subscription, open_session
from wayline.codec import decode
from wayline.keys import Key, parse_key
from wayline.messages import GpsFix
from wayline_bench import echo
from wayline_bench.feeder import Fed, ReceiverFeed, feed
from wayline_cli.local_system import LocalSystem

START_S = 20.0
SERVICE = "gps-ingest"


class Layout(NamedTuple):
    """Receivers of one kind shared out among processes."""

    name: str
    ports: Mapping[str, Sequence[int]]
    """Of each vehicle's receivers; a vehicle has one process."""
    kinds: frozenset[str]
    """Of sentences that they send."""

    @property
    def all_ports(self) -> tuple[int, ...]:
        """In the order of the feeder's receivers."""
        return tuple(port for ports in self.ports.values() for port in ports)

    def receivers(self) -> dict[tuple[str, str], int]:
        """The feeder's number of a receiver by vehicle and source."""
        origins = (
            (vehicle_id, SERVICE if number == 1 else f"{SERVICE}-{number}")
            for vehicle_id, ports in self.ports.items()
            for number in range(1, len(ports) + 1)
        )
        return {origin: who for who, origin in enumerate(origins)}


@dataclass(frozen=True)
class Ears:
    """What was heard when (monotonic clock); decoded when all is over."""

    fixes: list[tuple[str, bytes, float]] = field(default_factory=list)
    """Key and payload."""
    answers: list[tuple[bytes, float]] = field(default_factory=list)

    def on_fix(self, key: str, payload: bytes) -> None:
        """A fix came."""
        self.fixes.append((key, payload, time.monotonic()))

    def on_answer(self, sample: zenoh.Sample) -> None:
        """The echo came back."""
        self.answers.append((sample.payload.to_bytes(), time.monotonic()))


class Lived(NamedTuple):
    """What came of a layout; delays are those of what was heard."""

    name: str
    fed: Fed
    memory_mb: float
    fix_ms: list[float]
    """From sending a fix's last sentence to hearing the fix."""
    echo_ms: list[float]


def live(layout: Layout, rounds: int, round_s: float, echo_bytes: int) -> Lived:
    """Run a layout and feed it. Raises TimeoutError where a process does not start."""
    with contextlib.ExitStack() as stack:
        folder = Path(stack.enter_context(tempfile.TemporaryDirectory(prefix="wayline-bench-")))
        system = stack.enter_context(LocalSystem(folder, vehicle_id="bench"))
        _start(system, layout)
        session = stack.enter_context(open_session(system.bus))
        ears = stack.enter_context(_listening(session))
        pids = tuple(system.pid(vehicle_id) for vehicle_id in layout.ports)
        plan = ReceiverFeed(
            layout.all_ports, pids, system.bus, rounds, round_s, echo_bytes, layout.kinds
        )
        # not forked: Zenoh's threads would not come along
        spawn = multiprocessing.get_context("spawn")
        fed = stack.enter_context(ProcessPoolExecutor(1, spawn)).submit(feed, plan).result()
        memory_mb = sum(psutil.Process(pid).memory_info().rss for pid in pids) / 1e6
    receivers = layout.receivers()
    fix_s = {
        (receivers[key.vehicle_id, key.source], decode(key.topic, payload).t_ns): at_s
        for key, payload, at_s in _fixes(ears)
    }
    echo_s = {int(payload): at_s for payload, at_s in ears.answers}
    return Lived(
        layout.name,
        fed,
        memory_mb,
        [1e3 * (fix_s[sent] - at_s) for sent, at_s in fed.fix_sent_s.items() if sent in fix_s],
        [1e3 * (echo_s[sent] - at_s) for sent, at_s in fed.echo_sent_s.items() if sent in echo_s],
    )


def _fixes(ears: Ears) -> Iterator[tuple[Key, bytes, float]]:
    for text, payload, at_s in ears.fixes:
        key = parse_key(text)
        if key is not None:
            yield key, payload, at_s


def _start(system: LocalSystem, layout: Layout) -> None:
    """Router, echo and services; the feeder knows by their connections when they are ready."""
    system.start_router()
    (endpoint,) = system.bus.connect
    system.start_command("echo", (sys.executable, "-m", echo.__name__, endpoint))
    system.await_said("echo", echo.READY, START_S)
    for vehicle_id, ports in layout.ports.items():
        config = system.folder / f"{vehicle_id}.toml"
        lines = [f'vehicle_id = "{vehicle_id}"', "[bus]", f"connect = {json.dumps([endpoint])}"]
        lines += ["[http]", "port = 0"]
        for port in ports:
            lines += ["[[nmea]]", f'url = "tcp://127.0.0.1:{port}"']
        config.write_text("\n".join(lines))
        system.start_command(vehicle_id, (*system.command(SERVICE), "--config", str(config)))


@contextlib.contextmanager
def _listening(session: zenoh.Session) -> Iterator[Ears]:
    ears = Ears()
    fixes = Subscription(session, ["*"], [GpsFix.topic], ears.on_fix)
    answers = session.declare_subscriber(echo.ANSWER, ears.on_answer)
    yield ears
    answers.undeclare()  # type: ignore[no-untyped-call]
    fixes.close()
