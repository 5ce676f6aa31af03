"""The process that plays receivers over TCP, in turns with its yardsticks at the same pace.

These are bare messages to the echo, and pynmea2 alone on the same bursts: work that comes in
bursts costs more than in a tight loop, because others have had the caches in between.
"""

import contextlib
import socket
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field

import psutil
import zenoh

from wayline.bus import open_session
from wayline.settings import BusSettings
from wayline_bench.bare_nmea import FIX_READERS, parse_and_read
from wayline_bench.echo import ASK, numbered
from wayline_bench.made_up_log import RATE_HZ, epoch_lines, instant_ns

WARM_UP_S = 2.0
"""Receivers' order of sentences is learned meanwhile, and caches are filled."""
SETTLE_S = 0.2
"""What was sent last has been worked off by then."""
CONNECT_S = 60.0
"""Twenty processes that start on two cores take their time."""


Send = Callable[[int, int], None]
"""Is given the receiver and the epoch."""


@dataclass(frozen=True)
class ReceiverFeed:
    """What to feed, for how long, and whose CPU time to read."""

    ports: tuple[int, ...]
    """One a receiver, to listen on."""
    pids: tuple[int, ...]
    bus: BusSettings
    rounds: int
    round_s: float
    echo_bytes: int
    kinds: frozenset[str]
    """Of sentences that the receivers send."""


@dataclass(frozen=True)
class Fed:
    """What was sent when (monotonic clock), and what the fed processes spent meanwhile."""

    fix_sent_s: dict[tuple[int, int], float] = field(default_factory=dict)
    """By receiver and the instant of its fix, ns."""
    echo_sent_s: dict[int, float] = field(default_factory=dict)
    """By the message's number."""
    core_shares: list[float] = field(default_factory=list)
    """CPU seconds a second of the receivers' process, each round."""
    idle_shares: list[float] = field(default_factory=list)
    """CPU seconds a second while the receivers were silent, each round."""
    bare_shares: list[float] = field(default_factory=list)
    """What `pynmea2.parse` alone spent on the same bursts at the same pace."""


def feed(plan: ReceiverFeed) -> Fed:
    """Wait for every receiver's reader, warm it up, then let sentences and yardsticks take turns.

    Raises TimeoutError where a reader does not come.
    """
    fed = Fed()
    processes = [psutil.Process(pid) for pid in plan.pids]
    warm_up, length = round(WARM_UP_S * RATE_HZ), round(plan.round_s * RATE_HZ)
    bursts = [_burst(epoch, plan.kinds) for epoch in range(warm_up + plan.rounds * length)]
    with contextlib.ExitStack() as stack:
        peers = [stack.enter_context(peer) for peer in _accepted(plan.ports)]
        session = stack.enter_context(open_session(plan.bus))
        send_fix = _fix_sender(peers, bursts, fed)
        send_echo = _echo_sender(session.declare_publisher(ASK), fed, plan.echo_bytes)
        _pace(range(warm_up), len(peers), lambda who, epoch: peers[who].sendall(bursts[epoch]))
        for number in range(plan.rounds):
            start = warm_up + number * length
            epochs = range(start, start + length)
            with _spent(processes, fed.core_shares):
                _pace(epochs, len(peers), send_fix)
            with _spent(processes, fed.idle_shares):
                _pace(epochs, len(peers), send_echo)
            fed.bare_shares.append(_bare_share(epochs, len(peers), bursts))
    return fed


def _accepted(ports: Sequence[int]) -> Iterator[socket.socket]:
    for server in [socket.create_server(("127.0.0.1", port)) for port in ports]:
        with server:
            server.settimeout(CONNECT_S)
            peer, _ = server.accept()
            peer.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            yield peer


def _burst(epoch: int, kinds: frozenset[str]) -> bytes:
    return "".join(f"{line}\r\n" for line in epoch_lines(epoch) if line[3:6] in kinds).encode()


def _fix_sender(peers: Sequence[socket.socket], bursts: Sequence[bytes], fed: Fed) -> Send:
    def send(who: int, epoch: int) -> None:
        fed.fix_sent_s[who, instant_ns(epoch)] = time.monotonic()
        peers[who].sendall(bursts[epoch])

    return send


def _echo_sender(echo: zenoh.Publisher, fed: Fed, size_bytes: int) -> Send:
    def send(who: int, epoch: int) -> None:
        del who, epoch
        number = len(fed.echo_sent_s)
        payload = numbered(number, size_bytes)
        fed.echo_sent_s[number] = time.monotonic()
        echo.put(payload)

    return send


def _bare_share(epochs: range, receivers: int, bursts: Sequence[bytes]) -> float:
    """CPU seconds a second of this thread alone, the waiting between the bursts left out."""
    spent_s = 0.0

    def parse(who: int, epoch: int) -> None:
        nonlocal spent_s
        del who
        started_s = time.thread_time()
        parse_and_read(bursts[epoch].decode().splitlines(), FIX_READERS)
        spent_s += time.thread_time() - started_s

    _pace(epochs, receivers, parse)
    return spent_s * RATE_HZ / len(epochs)


def _pace(epochs: range, receivers: int, send: Send) -> None:
    """Each epoch of each receiver at its time; the receivers are spread evenly over an epoch."""
    started_s = time.monotonic()
    for epoch in epochs:
        for who in range(receivers):
            due_s = started_s + (epoch - epochs[0] + who / receivers) / RATE_HZ
            time.sleep(max(due_s - time.monotonic(), 0.0))
            send(who, epoch)
    time.sleep(SETTLE_S)


@contextlib.contextmanager
def _spent(processes: Sequence[psutil.Process], shares: list[float]) -> Iterator[None]:
    started_s, spent_s = time.monotonic(), _cpu_s(processes)
    yield
    shares.append((_cpu_s(processes) - spent_s) / (time.monotonic() - started_s - SETTLE_S))


def _cpu_s(processes: Sequence[psutil.Process]) -> float:
    times = [process.cpu_times() for process in processes]
    return sum(each.user + each.system for each in times)
