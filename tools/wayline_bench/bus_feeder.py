"""The process that plays a bus, in turns with bare messages to the echo at its messages' pace."""

import contextlib
import time
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from itertools import islice

import psutil

from wayline.bus import open_session
from wayline.settings import BusSettings
from wayline_bench.bare_bus import open_bus
from wayline_bench.echo import ASK, numbered
from wayline_bench.made_up_bus import MAPPED_IDS, NUMBERED_ID, RATE_HZ, frame, identifiers

BATCH_HZ = 1000
"""An adapter gives what has come in the last millisecond."""
WARM_UP_S = 2.0
SETTLE_S = 0.3
"""What was sent last has been worked off by then."""


@dataclass(frozen=True)
class BusFeed:
    """What to send, for how long, and whose CPU time to read."""

    group: str
    port: int
    pids: Mapping[str, int]
    bus: BusSettings
    only_mapped: bool
    rounds: int
    round_s: float
    echo_bytes: int


@dataclass(frozen=True)
class Fed:
    """What was sent when (monotonic clock), and what the processes spent meanwhile."""

    mapped: dict[int, int] = field(default_factory=dict)
    """Frames sent of each mapped identifier, warm-up included."""
    sent_s: dict[int, float] = field(default_factory=dict)
    """Of each numbered frame after the warm-up."""
    echo_sent_s: dict[int, float] = field(default_factory=dict)
    shares: dict[str, list[float]] = field(default_factory=dict)
    """CPU seconds a second of each process, each round."""


def feed(plan: BusFeed) -> Fed:
    """Warm up, then let frames and echo take turns."""
    fed = Fed(mapped=dict.fromkeys(MAPPED_IDS, 0), shares={name: [] for name in plan.pids})
    processes = {name: psutil.Process(pid) for name, pid in plan.pids.items()}
    share = len(MAPPED_IDS) / len(set(islice(identifiers(only_mapped=plan.only_mapped), 100)))
    echo_batch = max(round(share * RATE_HZ / BATCH_HZ), 1)
    # fewer than one message a batch are sent in fewer batches
    echo_hz = min(round(share * RATE_HZ), BATCH_HZ)
    with contextlib.ExitStack() as stack:
        bus = stack.enter_context(open_bus(plan.group, plan.port))
        session = stack.enter_context(open_session(plan.bus))
        echo = session.declare_publisher(ASK)
        order = identifiers(only_mapped=plan.only_mapped)

        def send() -> None:
            for identifier in islice(order, RATE_HZ // BATCH_HZ):
                number = fed.mapped.get(identifier, 0)
                message = frame(identifier, number)
                if identifier == NUMBERED_ID:
                    fed.sent_s[number] = time.monotonic()
                bus.send(message)
                if identifier in fed.mapped:
                    fed.mapped[identifier] = number + 1

        def ask() -> None:
            for _ in range(echo_batch):
                number = len(fed.echo_sent_s)
                fed.echo_sent_s[number] = time.monotonic()
                echo.put(numbered(number, plan.echo_bytes))

        _pace(send, BATCH_HZ, WARM_UP_S)
        fed.sent_s.clear()
        for _ in range(plan.rounds):
            with _spent(processes, fed.shares):
                _pace(send, BATCH_HZ, plan.round_s)
            _pace(ask, echo_hz, plan.round_s)
    return fed


def _pace(act: Callable[[], None], rate_hz: int, length_s: float) -> None:
    started_s = time.monotonic()
    for number in range(round(length_s * rate_hz)):
        time.sleep(max(started_s + number / rate_hz - time.monotonic(), 0.0))
        act()
    time.sleep(SETTLE_S)


@contextlib.contextmanager
def _spent(
    processes: Mapping[str, psutil.Process], shares: dict[str, list[float]]
) -> Iterator[None]:
    started_s = time.monotonic()
    before_s = {name: _cpu_s(process) for name, process in processes.items()}
    yield
    elapsed_s = time.monotonic() - started_s - SETTLE_S
    for name, process in processes.items():
        shares[name].append((_cpu_s(process) - before_s[name]) / elapsed_s)


def _cpu_s(process: psutil.Process) -> float:
    times = process.cpu_times()
    return float(times.user + times.system)
