"""Fifty pages that look and three that never read: nobody waits for another's line."""

import asyncio
import contextlib
import datetime as dt
import logging
import socket
import threading
import time
from collections.abc import Iterator
from urllib.parse import urlsplit

import msgspec
import numpy as np
from websockets.asyncio.client import connect

from besieged import Besieged, Bus
from lasting import lasting_s
from siege.soak import sample

log = logging.getLogger(__name__)

PAGES, DEAF = 50, 3
OTHERS = 100
"""Vehicles besides, so that a page that does not read soon has a full line."""
LATE_S = 1.0
RATE_HZ = 2.0
"""At least, of the ten a second that there are: fifty pages on two busy cores."""
MEMORY_BYTES = 5_000_000
"""What lines cost is there in the first half; what a line that is not read were to keep is not."""
SMALL_BYTES = 4_096


class Told(msgspec.Struct):
    """What of a page's message tells how late it is."""

    now: dt.datetime


async def look(url: str, until_s: float, lags_s: list[float]) -> None:
    """Read as a page does, and note how late each message is."""
    async with connect(url, max_size=None) as line:
        while (left_s := until_s - time.monotonic()) > 0.0:
            with contextlib.suppress(TimeoutError):
                text = await asyncio.wait_for(line.recv(), left_s)
                now = msgspec.json.decode(text, type=Told).now
                lags_s.append((dt.datetime.now(dt.UTC) - now).total_seconds())


async def look_all(url: str, seconds: float, pid: int) -> tuple[list[list[float]], int]:
    """The lags of every page, and by how many bytes the dashboard grew in the second half."""
    lags_s: list[list[float]] = [[] for _ in range(PAGES)]
    until_s = time.monotonic() + seconds

    async def half_time() -> int:
        await asyncio.sleep(seconds / 2.0)
        return sample(pid).memory_bytes

    half_bytes = asyncio.create_task(half_time())
    await asyncio.gather(*(look(url, until_s, own) for own in lags_s))
    return lags_s, sample(pid).memory_bytes - await half_bytes


@contextlib.contextmanager
def deaf(url: str) -> Iterator[None]:
    """A page that opens its line and never reads from it."""
    place = urlsplit(url)
    with socket.socket() as line:
        line.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, SMALL_BYTES)
        line.connect((place.hostname, place.port))
        line.sendall(
            f"GET {place.path} HTTP/1.1\r\nHost: {place.netloc}\r\nUpgrade: websocket\r\n"
            "Connection: Upgrade\r\nSec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\n"
            "Sec-WebSocket-Version: 13\r\n\r\n".encode()
        )
        yield


@contextlib.contextmanager
def crowd(besieged: Besieged, bus: Bus) -> Iterator[None]:
    """Many vehicles that say where they are while the block runs."""
    stop = threading.Event()

    def drive() -> None:
        while not stop.wait(0.2):
            pose = bus.pose(time.time_ns())
            for number in range(OTHERS):
                besieged.put(pose, f"crowd-{number}")

    thread = threading.Thread(target=drive)
    thread.start()
    try:
        yield
    finally:
        stop.set()
        thread.join()


def test_pages_that_never_read_cost_those_that_do_nothing(besieged: Besieged, bus: Bus) -> None:
    url = besieged.system.url("dashboard").replace("http", "ws", 1) + "/v1/live"
    seconds = lasting_s(2.0)
    with contextlib.ExitStack() as stack:
        stack.enter_context(crowd(besieged, bus))
        for _ in range(DEAF):
            stack.enter_context(deaf(url))
        pid = besieged.system.pid("dashboard")
        lags_s, grown_bytes = asyncio.run(look_all(url, seconds, pid))
    late_s = np.quantile(np.concatenate(lags_s), [0.5, 0.99])
    rates_hz = [len(own) / seconds for own in lags_s]
    log.info(
        "%d pages: %.1f to %.1f a second, lag p50 %.3f p99 %.3f s, %.1f MB more in the second half",
        PAGES,
        min(rates_hz),
        max(rates_hz),
        *late_s,
        grown_bytes * 1e-6,
    )
    assert min(rates_hz) > RATE_HZ
    assert late_s[1] < LATE_S
    assert grown_bytes < MEMORY_BYTES
    bus.await_known()
    besieged.assert_stands()
