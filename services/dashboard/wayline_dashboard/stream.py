"""One page's WebSocket: a snapshot, then changes, at the pace that its line takes."""

import asyncio

import msgspec
from fastapi import WebSocket, WebSocketDisconnect

from wayline.http_guard import TOKEN_PROTOCOL
from wayline_dashboard.fleet import Cursor
from wayline_dashboard.live_view import LiveView
from wayline_dashboard.view import FleetView

PROTOCOL = "wayline.v1"
"""Offered by the page beside its token, so that the token is not what the server answers with."""
PERIOD_S = 0.1
"""Poses come at 10 Hz; a page that looked more often would draw the same again."""
HEARTBEAT_S = 5.0


async def stream(websocket: WebSocket, live: LiveView, *, heartbeat_s: float = HEARTBEAT_S) -> None:
    """Serve a page until it goes; where nothing changes it still gets a heartbeat.

    Nothing is queued: `send_text` waits while the socket is full, and the next turn reads the
    newest state. So a slow line gets fewer updates and costs no memory.
    """
    await websocket.accept(subprotocol=_protocol(websocket))
    gone = asyncio.create_task(_until_gone(websocket))
    try:
        await _send_changes(websocket, live, gone, heartbeat_s)
    except WebSocketDisconnect:
        pass  # it went while it was being sent to
    finally:
        gone.cancel()


async def _send_changes(
    websocket: WebSocket, live: LiveView, gone: asyncio.Task[None], heartbeat_s: float
) -> None:
    loop = asyncio.get_running_loop()
    cursor = Cursor()
    sent_s = loop.time()
    while not gone.done():
        view = live.read(cursor)
        if view is None and loop.time() - sent_s >= heartbeat_s:
            view = live.heartbeat()
        if view is not None:
            await websocket.send_text(_encode(view))
            sent_s = loop.time()
        await asyncio.wait({gone}, timeout=PERIOD_S)


async def _until_gone(websocket: WebSocket) -> None:
    # pages have nothing to say; whatever one sends is read and let go
    while (await websocket.receive())["type"] != "websocket.disconnect":
        continue


def _protocol(websocket: WebSocket) -> str | None:
    offered = websocket.scope.get("subprotocols", [])
    chosen = [name for name in offered if not name.startswith(TOKEN_PROTOCOL)]
    return PROTOCOL if PROTOCOL in chosen else None


def _encode(view: FleetView) -> str:
    return msgspec.json.encode(view).decode()
