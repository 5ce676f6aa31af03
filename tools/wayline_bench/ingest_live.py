"""Twenty live receivers: what they cost in CPU and memory, and how late their fixes are."""

from collections.abc import Sequence

import numpy as np

from wayline.codec import encode
from wayline.inputs import Sentence
from wayline.messages import GpsFix
from wayline_bench.ingest_system import Layout, Lived, live
from wayline_bench.made_up_log import epoch_lines
from wayline_bench.rounds import Say
from wayline_bench.row import Row, compared
from wayline_cli.local_system import free_ports
from wayline_gps_ingest.core import GpsIngestCore

RECEIVERS = 20
ROUNDS = 8
ROUND_S = 1.5
"""Three take turns, and gps-ingest must not take a receiver that waits for its turn for dead."""
CORE_SHARE_BAR = 0.1
FEW = frozenset(("RMC", "GGA"))
ALL = frozenset(("RMC", "GGA", "VTG", "GSA", "GSV", "GST"))
"""14 sentences an epoch: as many as a line of 115200 baud carries ten times a second."""


def live_rows(say: Say) -> list[Row]:
    """One process for all receivers, then one for each."""
    ports = free_ports(RECEIVERS)
    name, own = f"{RECEIVERS} at 10 Hz, one process", {"bench": ports}
    apart = {f"bench-{number}": [port] for number, port in enumerate(ports)}
    few, one, many = (
        _lived(layout, say)
        for layout in (
            Layout(f"{name}, 2 sentences", own, FEW),
            Layout(f"{name}, 14 sentences", own, ALL),
            Layout(f"{RECEIVERS} at 10 Hz, a process each, 14 sentences", apart, ALL),
        )
    )
    memory = compared(
        f"{many.name}: memory", [many.memory_mb], [one.memory_mb], "one process", unit="MB"
    )
    bars = (CORE_SHARE_BAR, CORE_SHARE_BAR, None)
    lived = zip((few, one, many), bars, strict=True)
    return [*(row for each, bar in lived for row in _rows(each, bar)), memory]


def _lived(layout: Layout, say: Say) -> Lived:
    say(f"{layout.name}: {ROUNDS} rounds of {ROUND_S:g} s, yardsticks between them")
    return live(layout, ROUNDS, ROUND_S, _fix_bytes())


def _fix_bytes() -> int:
    """Size of a fix on the bus."""
    ingest = GpsIngestCore()
    sentences = (Sentence(0, line) for epoch in range(4) for line in epoch_lines(epoch))
    messages = (message for each in sentences for message in ingest.handle(each, "bench"))
    return max(len(encode(message)) for message in messages if isinstance(message, GpsFix))


def _rows(lived: Lived, core_share_bar: float | None) -> list[Row]:
    """CPU, losses and latency of a layout."""
    name, fed = lived.name, lived.fed
    cores = [1.0] * len(fed.core_shares)
    heard, sent = [float(len(lived.fix_ms))], [float(len(fed.fix_sent_s))]
    return [
        compared(f"{name}: CPU", fed.core_shares, cores, "core", bar=core_share_bar),
        compared(f"{name}: CPU", fed.core_shares, fed.bare_shares, "core, pynmea2.parse alone"),
        compared(f"{name}: CPU while silent", fed.idle_shares, cores, "core"),
        compared(f"{name}: fixes heard", heard, sent, "sent"),
        *(_latency(f"{name}: sentence to fix", lived, percent) for percent in (50, 99)),
    ]


def _latency(what: str, lived: Lived, percent: int) -> Row:
    ours, echo = (_percentile(delays_ms, percent) for delays_ms in (lived.fix_ms, lived.echo_ms))
    return compared(f"{what}, p{percent}", [ours], [echo], "bare Zenoh echo", unit="ms")


def _percentile(values: Sequence[float], percent: int) -> float:
    return float(np.percentile(values, percent))
