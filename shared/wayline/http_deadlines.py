"""Connections that ask for nothing are closed: deadlines for header and body, and a limit in all.

uvicorn closes a connection that idles between two requests, but waits for ever for the rest of a
request that has begun, and for the first one.
"""

import asyncio

import h11
from uvicorn.protocols.http.h11_impl import H11Protocol

HEADER_WITHIN_S = 10.0
"""From a connection's beginning, or a later request's first byte, to the end of its header."""
BODY_WITHIN_S = 20.0
"""From the end of a request's header to the end of its body."""
CONNECTIONS_MAX = 500
"""Half of the files that a process may have open unless it is told otherwise (1024)."""


class DeadlineProtocol(H11Protocol):
    """HTTP/1.1 for strangers: a request that does not come in time loses its connection."""

    _waits_for: object = None
    """The part of a request, as h11's state."""
    _deadline: asyncio.TimerHandle | None = None

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        """Begin to wait for a request; one connection too many is closed."""
        super().connection_made(transport)
        if len(self.connections) > CONNECTIONS_MAX:
            transport.abort()
            return
        self._wait()

    def data_received(self, data: bytes) -> None:
        """Take what came, and go on to wait for what is missing of the request."""
        super().data_received(data)
        self._wait()

    def connection_lost(self, exc: Exception | None) -> None:
        """Wait no longer."""
        self._end_wait()
        super().connection_lost(exc)

    def _wait(self) -> None:
        # a byte more of the same part gives no more time
        state = self.conn.their_state
        if state is self._waits_for and self._deadline is not None:
            return
        self._end_wait()
        self._waits_for = state
        limits_s: dict[object, float] = {h11.IDLE: HEADER_WITHIN_S, h11.SEND_BODY: BODY_WITHIN_S}
        limit_s = limits_s.get(state)
        if limit_s is not None and not self.transport.is_closing():
            self._deadline = self.loop.call_later(limit_s, self._give_up)

    def _end_wait(self) -> None:
        if self._deadline is not None:
            self._deadline.cancel()
            self._deadline = None

    def _give_up(self) -> None:
        # a WebSocket has taken the connection over, and its pings look after it
        if self.transport.get_protocol() is self:
            self.transport.close()
