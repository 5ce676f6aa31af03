"""The process that plays receivers over TCP, in turns with bare messages to the echo."""

import contextlib
import socket
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field

import psutil
import zenoh

from wayline.bus import open_session
from wayline.settings import BusSettings
from wayline_bench.echo import ASK, numbered
from wayline_bench.made_up_log import RATE_HZ, epoch_lines, instant_ns

WARM_UP_S = 2.0
"""Receivers' order of sentences is learned meanwhile, and caches are filled."""
SETTLE_S = 0.2
"""What was sent last has been worked off by then."""
CONNECT_S = 60.0
"""Twenty processes that start on two cores take their time."""


@dataclass(frozen=True)
class Plan:
    """What to feed, for how long, and whose CPU time to read."""

    ports: tuple[int, ...]
    """One a receiver, to listen on."""
    pids: tuple[int, ...]
    bus: BusSettings
    rounds: int
    round_s: float
    echo_bytes: int


@dataclass(frozen=True)
class Fed:
    """What was sent when (monotonic clock), and what the fed processes spent meanwhile."""

    fix_sent_s: dict[tuple[int, int], float] = field(default_factory=dict)
    """By receiver and the instant of its fix, ns."""
    echo_sent_s: dict[int, float] = field(default_factory=dict)
    """By the message's number."""
    core_shares: list[float] = field(default_factory=list)
    """CPU seconds a second, each round."""
    idle_shares: list[float] = field(default_factory=list)
    """The same while the receivers were silent."""


def feed(plan: Plan) -> Fed:
    """Wait for every receiver's reader, warm it up, then sentences and echoes in turns."""
    fed = Fed()
    processes = [psutil.Process(pid) for pid in plan.pids]
    epochs_a_round = round(plan.round_s * RATE_HZ)
    warm_up = round(WARM_UP_S * RATE_HZ)
    bursts = [_burst(epoch) for epoch in range(warm_up + plan.rounds * epochs_a_round)]
    with contextlib.ExitStack() as stack:
        peers = [stack.enter_context(peer) for peer in _accepted(plan.ports)]
        session = stack.enter_context(open_session(plan.bus))
        echo = session.declare_publisher(ASK)
        _send(range(warm_up), len(peers), lambda who, epoch: peers[who].sendall(bursts[epoch]))
        for number in range(plan.rounds):
            start = warm_up + number * epochs_a_round
            epochs = range(start, start + epochs_a_round)

            def send_fix(who: int, epoch: int) -> None:
                fed.fix_sent_s[who, instant_ns(epoch)] = time.monotonic()
                peers[who].sendall(bursts[epoch])

            with _spent(processes, fed.core_shares):
                _send(epochs, len(peers), send_fix)
            with _spent(processes, fed.idle_shares):
                _send(epochs, len(peers), _echo_sender(echo, fed, plan.echo_bytes))
    return fed


def _accepted(ports: Sequence[int]) -> Iterator[socket.socket]:
    for server in [socket.create_server(("127.0.0.1", port)) for port in ports]:
        with server:
            server.settimeout(CONNECT_S)
            peer, _ = server.accept()
            peer.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            yield peer


def _burst(epoch: int) -> bytes:
    return "".join(f"{line}\r\n" for line in epoch_lines(epoch)).encode()


def _echo_sender(echo: zenoh.Publisher, fed: Fed, size_bytes: int) -> Callable[[int, int], None]:
    def send(who: int, epoch: int) -> None:
        del who, epoch
        number = len(fed.echo_sent_s)
        payload = numbered(number, size_bytes)
        fed.echo_sent_s[number] = time.monotonic()
        echo.put(payload)

    return send


def _send(epochs: range, receivers: int, send: Callable[[int, int], None]) -> None:
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
