"""Asks a server over and over, on lines that stay open: as fast as it answers, or at a pace.

Callbacks all through: what a question costs here must be little beside what it costs there.
"""

import asyncio
import time
from collections import deque
from collections.abc import Awaitable, Callable
from functools import partial

LINES = 8
HEAD_END = b"\r\n\r\n"
LENGTH = b"content-length:"
Answered = Callable[["Line"], None]


class Line(asyncio.Protocol):
    """One connection, one question at a time."""

    def __init__(self, request: bytes) -> None:
        self._request = request
        self._answered: Answered | None = None
        self._came = b""
        self.failure: Exception | None = None

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """Keep where questions go."""
        assert isinstance(transport, asyncio.Transport)  # noqa: S101 - a socket's
        self.transport = transport

    def ask(self, answered: Answered) -> None:
        """Send a question; `answered` is called once the whole answer is there."""
        self._answered, self._came = answered, b""
        self.transport.write(self._request)

    def data_received(self, data: bytes) -> None:
        """Take a part of the answer."""
        self._came += data
        head, end, body = self._came.partition(HEAD_END)
        if not end or self._answered is None:
            return
        length = int(head.lower().partition(LENGTH)[2].partition(b"\r\n")[0])
        if len(body) >= length:
            if b" 200 " not in head[:16]:
                self.failure = RuntimeError(head.decode(errors="replace"))
            self._answered(self)


def rate_hz(port: int, path: str, seconds: float) -> float:
    """Answers a second, each line asking again as soon as it has been answered."""

    async def run(lines: list[Line]) -> list[float]:
        count, began_s = 0, time.perf_counter()

        def again(line: Line) -> None:
            nonlocal count
            count += 1
            line.ask(again)

        for line in lines:
            line.ask(again)
        await asyncio.sleep(seconds)
        return [count / (time.perf_counter() - began_s)]

    return asyncio.run(_with_lines(port, path, run))[0]


def latencies_s(port: int, path: str, hz: float, seconds: float) -> list[float]:
    """From when each question was due to its whole answer; who waits for a line is late too."""

    async def run(lines: list[Line]) -> list[float]:
        loop = asyncio.get_running_loop()
        free, waiting, waits_s = deque(lines), deque[float](), list[float]()
        over: asyncio.Future[None] = loop.create_future()
        count = int(hz * seconds)

        def due(due_s: float) -> None:
            waiting.append(due_s)
            go_on()

        def go_on() -> None:
            while free and waiting:
                line, due_s = free.popleft(), waiting.popleft()
                line.ask(partial(answered, due_s))

        def answered(due_s: float, line: Line) -> None:
            waits_s.append(loop.time() - due_s)
            free.append(line)
            go_on()
            if len(waits_s) == count:
                over.set_result(None)

        began_s = loop.time()
        for number in range(count):
            due_s = began_s + number / hz
            loop.call_at(due_s, due, due_s)
        await over
        return waits_s

    return asyncio.run(_with_lines(port, path, run))


async def _with_lines(
    port: int, path: str, work: Callable[[list[Line]], Awaitable[list[float]]]
) -> list[float]:
    """What the work measures on open lines. Raises RuntimeError for an answer that is not 200."""
    request = f"GET {path} HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\n\r\n".encode()
    loop = asyncio.get_running_loop()
    opened = [
        await loop.create_connection(lambda: Line(request), "127.0.0.1", port) for _ in range(LINES)
    ]
    lines = [line for _, line in opened]
    measured = await work(lines)
    for transport, _ in opened:
        transport.abort()
    for line in lines:
        if line.failure is not None:
            raise line.failure
    return measured
