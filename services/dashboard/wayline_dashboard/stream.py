"""One page's WebSocket: a snapshot, then changes, at the pace that its line takes."""

import asyncio
from typing import NamedTuple

import msgspec
from fastapi import WebSocket, WebSocketDisconnect

from wayline.http_guard import TOKEN_PROTOCOL
from wayline_dashboard.fleet import Cursor
from wayline_dashboard.live_view import LiveView
from wayline_dashboard.view import FleetView, Selection

PROTOCOL = "wayline.v1"
"""Offered by the page beside its token, so that the token is not what the server answers with."""
PERIOD_S = 0.1
"""Poses come at 10 Hz; a page that looked more often would draw the same again."""
HEARTBEAT_S = 5.0


class Refusal(NamedTuple):
    """Why a line is closed, as RFC 6455 section 7.4 has it."""

    code: int
    reason: str


NOT_TEXT = Refusal(1003, "a selection is sent as text")
NOT_A_SELECTION = Refusal(1007, 'a selection is {"vehicle_id": <id or null>}')


async def stream(
    websocket: WebSocket, live: LiveView, *, heartbeat_s: float = HEARTBEAT_S
) -> Refusal | None:
    """Serve a page until it goes, or until it says what is not understood, which is returned.

    Nothing is queued: `send_text` waits while the socket is full, and the next turn reads the
    newest state. So a slow line gets fewer updates and costs no memory. A selection is answered
    at the next turn, so a page that selects without end costs one vehicle's whole view a turn.
    Where nothing changes a page still gets a heartbeat.
    """
    await websocket.accept(subprotocol=_protocol(websocket))
    cursor = Cursor()
    hearing = asyncio.create_task(_hear(websocket, cursor))
    try:
        await _send_changes(websocket, live, cursor, hearing, heartbeat_s)
        refusal = await hearing
        if refusal is not None:
            await websocket.close(refusal.code, refusal.reason)
        return refusal
    except WebSocketDisconnect:
        return None  # it went while it was being sent to
    finally:
        hearing.cancel()


async def _send_changes(
    websocket: WebSocket,
    live: LiveView,
    cursor: Cursor,
    hearing: asyncio.Task[Refusal | None],
    heartbeat_s: float,
) -> None:
    loop = asyncio.get_running_loop()
    sent_s = loop.time()
    while not hearing.done():
        view = live.read(cursor)
        if view is None and loop.time() - sent_s >= heartbeat_s:
            view = live.heartbeat(cursor)
        if view is not None:
            await websocket.send_text(_encode(view))
            sent_s = loop.time()
        await asyncio.wait({hearing}, timeout=PERIOD_S)


async def _hear(websocket: WebSocket, cursor: Cursor) -> Refusal | None:
    while (event := await websocket.receive())["type"] != "websocket.disconnect":
        text = event.get("text")
        if text is None:
            return NOT_TEXT
        try:
            cursor.select(msgspec.json.decode(text, type=Selection).vehicle_id)
        except msgspec.DecodeError:
            return NOT_A_SELECTION
    return None


def _protocol(websocket: WebSocket) -> str | None:
    offered = websocket.scope.get("subprotocols", [])
    chosen = [name for name in offered if not name.startswith(TOKEN_PROTOCOL)]
    return PROTOCOL if PROTOCOL in chosen else None


def _encode(view: FleetView) -> str:
    return msgspec.json.encode(view).decode()
