import asyncio
import json
from typing import Any

from fastapi import WebSocket

from wayline.messages import Pose
from wayline_dashboard.live_view import LiveView
from wayline_dashboard.stream import stream

NOW_NS = 1_700_000_000_000_000_000


class Line:
    """A page's end of a WebSocket that takes nothing while it is held."""

    def __init__(self) -> None:
        self.taken: list[dict[str, Any]] = []
        self.free = asyncio.Event()
        self.free.set()
        self._gone: asyncio.Queue[dict[str, Any]] = asyncio.Queue()
        self._gone.put_nowait({"type": "websocket.connect"})

    def websocket(self) -> WebSocket:
        scope = {"type": "websocket", "path": "/v1/live", "headers": [], "subprotocols": []}
        return WebSocket(scope, self._gone.get, self._send)

    async def _send(self, message: Any) -> None:
        await self.free.wait()
        if message["type"] == "websocket.send":
            self.taken.append(json.loads(message["text"]))

    def leave(self) -> None:
        self._gone.put_nowait({"type": "websocket.disconnect", "code": 1001})


def pose(step: int) -> Pose:
    lat_deg = 39.9 + step * 1e-4
    return Pose(t_ns=NOW_NS + step, mode="fused", lat_deg=lat_deg, lon_deg=-75.35)


async def until(line: Line, count: int) -> None:
    async with asyncio.timeout(5.0):
        while len(line.taken) < count:
            await asyncio.sleep(0.01)


async def watch_slowly() -> list[dict[str, Any]]:
    live, line = LiveView(), Line()
    live.put("shuttle", pose(0), "fusion")
    served = asyncio.create_task(stream(line.websocket(), live))
    await until(line, 1)
    line.free.clear()
    for step in range(1, 301):
        live.put("shuttle", pose(step), "fusion")
        await asyncio.sleep(0.001)
    line.free.set()
    await until(line, 3)
    line.leave()
    await asyncio.wait_for(served, 5.0)
    return line.taken


def test_a_slow_page_gets_fewer_updates_and_the_newest_state() -> None:
    snapshot, stuck, newest = asyncio.run(watch_slowly())
    assert snapshot["kind"] == "snapshot"
    assert len(stuck["vehicles"][0]["trail"]) < 300
    [vehicle] = newest["vehicles"]
    assert vehicle["pose"]["lat_deg"] == pose(300).lat_deg
    points = sum(len(view["vehicles"][0]["trail"]) for view in (snapshot, stuck, newest))
    assert points == 301


async def leave_at_once() -> None:
    live, line = LiveView(), Line()
    served = asyncio.create_task(stream(line.websocket(), live))
    await until(line, 1)
    line.leave()
    await asyncio.wait_for(served, 1.0)


def test_a_page_that_leaves_ends_its_stream_though_nothing_changes() -> None:
    asyncio.run(leave_at_once())


async def listen_to_silence() -> list[dict[str, Any]]:
    live, line = LiveView(), Line()
    served = asyncio.create_task(stream(line.websocket(), live, heartbeat_s=0.1))
    await until(line, 3)
    line.leave()
    await asyncio.wait_for(served, 1.0)
    return line.taken


def test_a_silent_fleet_still_sends_signs_of_life() -> None:
    snapshot, beat, *_ = asyncio.run(listen_to_silence())
    assert snapshot["kind"] == "snapshot"
    assert (beat["kind"], beat["vehicles"], beat["services"]) == ("changes", [], None)
