"""Pure: rows of single satellites into the epochs that they are of."""

import heapq
from collections import Counter
from collections.abc import Iterable, Iterator

from wayline.messages import LIST_MAX, RawSatellite
from wayline_gps_ingest.raw.epoch import RawEpoch

MILLISECOND_NS = 1_000_000
EPOCH_NS = 5 * MILLISECOND_NS
"""Rows within so much of an epoch's first are of it; receivers make at most 50 epochs a second."""
DISORDER_NS = 2_000 * MILLISECOND_NS
"""Rows may come so much after later ones."""

Row = tuple[int, RawSatellite]
"""Of when (Unix ns), and what."""


def gathered(rows: Iterable[Row], faults: Counter[str]) -> Iterator[RawEpoch]:
    """The epochs in order of time; each stamped with its first row.

    `faults` counts rows that are left out: `late` (of an epoch that is over), `twice` (a signal
    that the epoch has already).
    """
    first_ns, signals = 0, dict[tuple[object, ...], RawSatellite]()
    for t_ns, satellite in _in_order(rows):
        if t_ns < first_ns:
            faults["late"] += 1
            continue
        if t_ns > first_ns + EPOCH_NS:
            if signals:
                yield RawEpoch(t_ns=first_ns, satellites=tuple(signals.values()))
            first_ns, signals = t_ns, {}
        signal = satellite.system, satellite.prn, satellite.carrier_hz
        if signal in signals or len(signals) == LIST_MAX:
            faults["twice"] += 1
        else:
            signals[signal] = satellite
    if signals:
        yield RawEpoch(t_ns=first_ns, satellites=tuple(signals.values()))


def _in_order(rows: Iterable[Row]) -> Iterator[Row]:
    """Rows by time, as far as they are not too late; those of one time as they came."""
    held: list[tuple[int, int, RawSatellite]] = []
    latest_ns = 0
    for number, (t_ns, satellite) in enumerate(rows):
        heapq.heappush(held, (t_ns, number, satellite))
        latest_ns = max(latest_ns, t_ns)
        while held[0][0] < latest_ns - DISORDER_NS:
            first_ns, _, first = heapq.heappop(held)
            yield first_ns, first
    while held:
        first_ns, _, first = heapq.heappop(held)
        yield first_ns, first
