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
ROUND_S = 2.5
"""Shorter than the silence after which gps-ingest takes a peer for dead: the echo has turns too."""
CORE_SHARE_BAR = 0.1


def live_rows(say: Say) -> list[Row]:
    """One process for all receivers, then one for each."""
    ports = free_ports(RECEIVERS)
    together = Layout(f"{RECEIVERS} receivers, one process", {"bench": ports})
    apart = Layout(
        f"{RECEIVERS} receivers, a process each",
        {f"bench-{number}": [port] for number, port in enumerate(ports)},
    )
    one, many = (_lived(layout, say) for layout in (together, apart))
    memory = compared(
        f"{many.name}: memory", [many.memory_mb], [one.memory_mb], "one process", unit="MB"
    )
    return [*_rows(one, CORE_SHARE_BAR), *_rows(many, None), memory]


def _lived(layout: Layout, say: Say) -> Lived:
    say(f"{layout.name}: {ROUNDS} rounds of {ROUND_S:g} s, the echo's between them")
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
        compared(f"{name}: CPU while they are silent", fed.idle_shares, cores, "core"),
        compared(f"{name}: fixes heard", heard, sent, "sent"),
        *(_latency(f"{name}: sentence to fix heard", lived, percent) for percent in (50, 99)),
    ]


def _latency(what: str, lived: Lived, percent: int) -> Row:
    ours, echo = (_percentile(delays_ms, percent) for delays_ms in (lived.fix_ms, lived.echo_ms))
    return compared(f"{what}, p{percent}", [ours], [echo], "bare Zenoh echo", unit="ms")


def _percentile(values: Sequence[float], percent: int) -> float:
    return float(np.percentile(values, percent))
