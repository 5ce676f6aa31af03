"""Floods of some vehicles: what does not fit is theirs, and the others are on time."""

import logging
import os
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from besieged import Besieged, Bus
from lasting import MINUTES, lasting_s
from wayline_cli.local_system import LocalSystem

log = logging.getLogger(__name__)

FLOODER = Path(__file__).parents[1] / "flooder.py"
SECOND_NS = 1_000_000_000
MISSED_MAX = 1
WAIT_S = 60.0


def flood(system: LocalSystem, name: str, seconds: float, rate_hz: float, size: int) -> None:
    """Start a program that floods a bus as a vehicle of that name."""
    endpoint = system.bus.connect[0]
    arguments = (endpoint, name, str(seconds), str(rate_hz), str(size))
    path = f"PYTHONPATH={os.pathsep.join(map(str, (FLOODER.parent,)))}"
    command = ("env", path, sys.executable, str(FLOODER), *arguments)
    system.start_command(name, command)


LONG = pytest.mark.skipif(not MINUTES, reason="long: scripts/siege flood")
FLOODS = [
    pytest.param([(20_000.0, 0)], 0.5, id="one at 20,000 a second"),
    pytest.param([(0.0, 0)] * 3, 3.0, id="three unpaced"),
    pytest.param([(0.0, 0)], 3.0, id="one unpaced", marks=LONG),
    pytest.param([(200.0, 200_000)] * 2, 0.5, id="two with heavy messages", marks=LONG),
]
"""Rate and payload of each flood, and how late another vehicle's progress may be."""


@pytest.mark.parametrize(("floods", "late_s"), FLOODS)
def test_a_flood_costs_nobody_else_a_message(
    besieged: Besieged, bus: Bus, floods: list[tuple[float, int]], late_s: float
) -> None:
    seconds = lasting_s(2.0)
    before = {service: besieged.health(service).dropped for service in besieged.services}
    started_ns, started = time.time_ns(), len(bus.sent)
    names = [f"flood-{number}" for number in range(len(floods))]
    for name, (rate_hz, size) in zip(names, floods, strict=True):
        flood(besieged.system, name, seconds, rate_hz, size)
    for name in names:
        assert besieged.system.await_end(name, seconds + WAIT_S) == 0
    bus.await_known()
    due = {t_ns: sent_s for t_ns, sent_s in bus.sent[started:-20] if t_ns % SECOND_NS == 0}
    told = {
        each.message.t_ns: each.received_s
        for each in besieged.listener.heard("progress")
        if each.message.t_ns > started_ns
    }
    lags_s = [told[t_ns] - sent_s for t_ns, sent_s in due.items() if t_ns in told]
    dropped = {
        service: besieged.health(service).dropped - count for service, count in before.items()
    }
    sent = [besieged.system.said(name).strip() for name in names]
    log.info(
        "flood of %s: %d of %d told, lag p50 %.3f p99 %.3f s, dropped %s",
        sent,
        len(lags_s),
        len(due),
        *np.quantile(lags_s, [0.5, 0.99]),
        dropped,
    )
    assert len(lags_s) >= len(due) - MISSED_MAX
    assert np.quantile(lags_s, 0.99) < late_s
    besieged.assert_stands()
