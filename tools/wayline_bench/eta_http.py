"""Eta's answers over HTTP beside a bare FastAPI endpoint that sends the same bytes.

Each server is a process of its own; eta's is told of its vehicle once a second meanwhile.
"""

import contextlib
import subprocess
import sys
from collections.abc import Callable, Iterator, Mapping

import numpy as np

from wayline_bench.http_load import latencies_s, rate_hz
from wayline_bench.rounds import Say
from wayline_bench.row import Row, compared

VEHICLE = "bus-1"
PATH = f"/v1/vehicles/{VEHICLE}/arrivals"
ROUNDS = 5
ROUND_S = 3.0
BAR = 2.0
"""Ours may take so many times as long, for an answer and for the slowest hundredth of them."""
MODULE = "wayline_bench.eta_http_server"
YARDSTICK = "bare FastAPI, same bytes"


def http_rows(say: Say) -> list[Row]:
    """An answer where as many as possible are asked for, and p99 at a third of the bare rate."""
    with server(MODULE, "ours") as ours, server(MODULE, "bare") as bare:
        ports = {"ours": ours, "bare": bare}
        spent_us = alternating(
            ports, lambda port: answer_us(port, PATH), lambda text: say(f"http: {text}")
        )
        pace_hz = 1e6 / float(np.median(spent_us["bare"])) / 3.0
        p99_ms = alternating(
            ports, lambda port: _p99_ms(port, pace_hz), lambda text: say(f"http, p99: {text}")
        )
    what = "HTTP: 1 answer of 30 arrivals, as many as can be"
    paced = "HTTP: p99 at a third of the bare one's most"
    return [
        compared(what, spent_us["ours"], spent_us["bare"], YARDSTICK, unit="us", bar=BAR),
        compared(paced, p99_ms["ours"], p99_ms["bare"], YARDSTICK, unit="ms", bar=BAR),
    ]


def alternating(
    ports: Mapping[str, int], measure: Callable[[int], float], say: Say
) -> dict[str, list[float]]:
    """Rounds of each in turn; the first warms up and is not kept."""
    found: dict[str, list[float]] = {name: [] for name in ports}
    for number in range(ROUNDS + 1):
        say(f"round {number} of {ROUNDS}")
        for name in list(ports)[:: 1 if number % 2 else -1]:
            figure = measure(ports[name])
            if number:
                found[name].append(figure)
    return found


def answer_us(port: int, path: str) -> float:
    """Microseconds an answer, where as many as possible are asked for."""
    return 1e6 / rate_hz(port, path, ROUND_S)


def _p99_ms(port: int, pace_hz: float) -> float:
    return 1e3 * float(np.quantile(latencies_s(port, PATH, pace_hz, ROUND_S), 0.99))


@contextlib.contextmanager
def server(module: str, kind: str) -> Iterator[int]:
    """The port of a server process that ends with the block."""
    command = [sys.executable, "-m", module, kind]
    with subprocess.Popen(  # noqa: S603 - our own module
        command, stdin=subprocess.PIPE, stdout=subprocess.PIPE
    ) as process:
        if process.stdin is None or process.stdout is None:
            raise RuntimeError("a server without pipes")
        line = process.stdout.readline()
        if not line.strip().isdigit():
            raise RuntimeError(f"the {kind} server did not start; see above")
        yield int(line)
        process.stdin.close()
