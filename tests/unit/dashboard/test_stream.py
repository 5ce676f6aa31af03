import asyncio
import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from fastapi import WebSocket
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import ClientConnection, connect

from wayline.http_server import MESSAGE_MAX_BYTES, HttpServer
from wayline.http_settings import HttpSettings
from wayline.messages import Horizon, HorizonPoint, Pose
from wayline.view import Receipt
from wayline_dashboard.app import create_dashboard
from wayline_dashboard.live_view import LiveView
from wayline_dashboard.stream import Refusal, stream

NOW_NS = 1_700_000_000_000_000_000


class Line:
    """A page's end of a WebSocket that takes nothing while it is held."""

    def __init__(self) -> None:
        self.taken: list[dict[str, Any]] = []
        self.closed: dict[str, Any] | None = None
        self.free = asyncio.Event()
        self.free.set()
        self._said: asyncio.Queue[dict[str, Any]] = asyncio.Queue()
        self._said.put_nowait({"type": "websocket.connect"})

    def websocket(self) -> WebSocket:
        scope = {"type": "websocket", "path": "/v1/live", "headers": [], "subprotocols": []}
        return WebSocket(scope, self._said.get, self._send)

    async def _send(self, message: Any) -> None:
        await self.free.wait()
        if message["type"] == "websocket.send":
            self.taken.append(json.loads(message["text"]))
        elif message["type"] == "websocket.close":
            self.closed = message

    def say(self, **content: Any) -> None:
        self._said.put_nowait({"type": "websocket.receive", **content})

    def select(self, vehicle_id: str | None) -> None:
        self.say(text=json.dumps({"vehicle_id": vehicle_id}))

    def leave(self) -> None:
        self._said.put_nowait({"type": "websocket.disconnect", "code": 1001})


def pose(step: int) -> Pose:
    lat_deg = 39.9 + step * 1e-4
    return Pose(t_ns=NOW_NS + step, mode="fused", lat_deg=lat_deg, lon_deg=-75.35)


async def until(line: Line, count: int) -> None:
    async with asyncio.timeout(5.0):
        while len(line.taken) < count:
            await asyncio.sleep(0.01)


async def watch_slowly() -> list[dict[str, Any]]:
    live, line = LiveView(), Line()
    live.put("shuttle", pose(0), "fusion", Receipt(0))
    line.select("shuttle")
    served = asyncio.create_task(stream(line.websocket(), live))
    await until(line, 2)
    line.free.clear()
    for step in range(1, 301):
        live.put("shuttle", pose(step), "fusion", Receipt(0))
        await asyncio.sleep(0.001)
    line.free.set()
    await until(line, 4)
    line.leave()
    await asyncio.wait_for(served, 5.0)
    return line.taken


def test_a_slow_page_gets_fewer_updates_and_the_newest_state() -> None:
    snapshot, selected, stuck, newest = asyncio.run(watch_slowly())
    assert snapshot["kind"] == "snapshot"
    assert len(stuck["vehicles"][0]["trail"]) < 300
    [vehicle] = newest["vehicles"]
    assert vehicle["pose"]["lat_deg"] == pose(300).lat_deg
    points = sum(len(view["vehicles"][0]["trail"]) for view in (selected, stuck, newest))
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


def horizon(grade_pct: float) -> Horizon:
    return Horizon(t_ns=NOW_NS, points=(HorizonPoint(distance_m=0.0, grade_pct=grade_pct),))


async def select_in_turn() -> list[dict[str, Any]]:
    live, line = LiveView(), Line()
    for number, vehicle_id in enumerate(("alpha", "beta")):
        live.put(vehicle_id, pose(number), "fusion", Receipt(0))
        live.put(vehicle_id, horizon(float(number)), "slope-map", Receipt(0))
    served = asyncio.create_task(stream(line.websocket(), live))
    await until(line, 1)
    for selected in ("alpha", "beta", None):
        line.select(selected)
        await until(line, len(line.taken) + 1)
    line.leave()
    assert await asyncio.wait_for(served, 1.0) is None
    return line.taken


def test_a_page_that_selects_a_vehicle_gets_its_newest_horizon_though_nothing_changes() -> None:
    snapshot, alpha, beta, none = asyncio.run(select_in_turn())
    assert snapshot["selected"] is None
    assert "horizon" not in str(snapshot)
    for view, vehicle_id, grade_pct in ((alpha, "alpha", 0.0), (beta, "beta", 1.0)):
        [vehicle] = view["vehicles"]
        assert view["selected"] == vehicle["vehicle_id"] == vehicle_id
        assert vehicle["horizon"]["points"][0]["grade_pct"] == grade_pct
    assert (none["selected"], none["vehicles"]) == (None, [])


async def say(content: dict[str, Any]) -> tuple[Refusal | None, Any]:
    live, line = LiveView(), Line()
    line.say(**content)
    refusal = await asyncio.wait_for(stream(line.websocket(), live), 1.0)
    return refusal, line.closed


@pytest.mark.parametrize(
    ("content", "code"),
    [
        ({"text": "alpha"}, 1007),
        ({"text": "{}"}, 1007),
        ({"text": '{"vehicle_id": 7}'}, 1007),
        ({"text": '{"vehicle_id": "No Vehicle/s Id"}'}, 1007),
        ({"bytes": b'{"vehicle_id": "alpha"}'}, 1003),
    ],
)
def test_a_page_that_is_not_understood_is_told_why_and_closed(
    content: dict[str, Any], code: int
) -> None:
    refusal, closed = asyncio.run(say(content))
    assert refusal is not None
    assert (refusal.code, closed["code"], closed["reason"]) == (code, code, refusal.reason)


@pytest.fixture
def opened(tmp_path: Path) -> Iterator[ClientConnection]:
    """A page's line to a real server, its snapshot taken."""
    app = create_dashboard(LiveView(), HttpSettings(), static=tmp_path)
    with (
        HttpServer(app, HttpSettings(port=0)) as server,
        connect(f"ws://127.0.0.1:{server.port}/v1/live") as line,
    ):
        line.recv(timeout=5.0)
        yield line


@pytest.mark.parametrize(
    ("said", "code"),
    [
        (f'{{"vehicle_id": null, "ballast": "{MESSAGE_MAX_BYTES * "x"}"}}', 1009),
        ("alpha", 1007),
        (b"alpha", 1003),
    ],
)
def test_over_a_real_line_the_close_code_says_what_was_wrong(
    opened: ClientConnection, said: str | bytes, code: int
) -> None:
    opened.send(said)
    with pytest.raises(ConnectionClosed):
        opened.recv(timeout=5.0)
    assert opened.close_code == code
