"""Half-sent requests lose their connection; whoever asks properly is answered meanwhile."""

import contextlib
import http.client
import socket
import time
from collections.abc import Iterator

import pytest
from starlette.applications import Starlette
from starlette.requests import Request
from starlette.responses import PlainTextResponse
from starlette.routing import Route

from wayline import http_deadlines
from wayline.http_server import HttpServer
from wayline.http_settings import HttpSettings

WITHIN_S = 0.3


async def echo(request: Request) -> PlainTextResponse:
    return PlainTextResponse(str(len(await request.body())))


@pytest.fixture
def port(monkeypatch: pytest.MonkeyPatch) -> Iterator[int]:
    monkeypatch.setattr(http_deadlines, "HEADER_WITHIN_S", WITHIN_S)
    monkeypatch.setattr(http_deadlines, "BODY_WITHIN_S", WITHIN_S)
    monkeypatch.setattr(http_deadlines, "CONNECTIONS_MAX", 20)
    app = Starlette(routes=[Route("/echo", echo, methods=["GET", "POST"])])
    with HttpServer(app, HttpSettings(port=0)) as server:
        yield server.port


def open_seconds(port: int, *parts: bytes, every_s: float = 0.0) -> float:
    """How long the server keeps a connection on which these parts are sent."""
    began_s = time.monotonic()
    with socket.create_connection(("127.0.0.1", port), timeout=10.0) as line:
        for part in parts:
            line.sendall(part)
            time.sleep(every_s)
        while line.recv(4096):
            pass
    return time.monotonic() - began_s


HALF = b"GET /echo HTTP/1.1\r\nHost: localhost\r\n"


@pytest.mark.parametrize(
    "parts",
    [
        (),
        (HALF,),
        (b"POST /echo HTTP/1.1\r\nHost: localhost\r\nContent-Length: 5\r\n\r\nabc",),
        (b"GET /echo HTTP/1.1\r\nHost: localhost\r\n\r\n", HALF),
    ],
    ids=["nothing", "half a header", "half a body", "half a second header"],
)
def test_what_does_not_come_in_time_ends(port: int, parts: tuple[bytes, ...]) -> None:
    assert WITHIN_S / 2.0 < open_seconds(port, *parts, every_s=0.02) < 3.0


def test_a_byte_now_and_then_gives_no_more_time(port: int) -> None:
    with socket.create_connection(("127.0.0.1", port), timeout=10.0) as line:
        began_s = time.monotonic()
        line.settimeout(0.02)
        for byte in HALF * 100:
            line.sendall(bytes([byte]))
            with contextlib.suppress(TimeoutError):
                assert line.recv(1) == b""
                break
        assert time.monotonic() - began_s < 3.0


def test_a_connection_goes_on_over_requests_as_long_as_they_come(port: int) -> None:
    line = http.client.HTTPConnection("127.0.0.1", port, timeout=5.0)
    for _ in range(5):
        line.request("POST", "/echo", body=b"abc")
        assert line.getresponse().read() == b"3"
        time.sleep(WITHIN_S / 2.0)
    line.close()


def test_a_crowd_of_idle_connections_is_turned_away_and_ends(port: int) -> None:
    lines = [socket.create_connection(("127.0.0.1", port), timeout=5.0) for _ in range(40)]
    try:
        until_s = time.monotonic() + 5.0
        while time.monotonic() < until_s:
            line = http.client.HTTPConnection("127.0.0.1", port, timeout=5.0)
            try:
                line.request("GET", "/echo")
                if line.getresponse().status == http.client.OK:
                    break
            except OSError:
                time.sleep(0.05)
            finally:
                line.close()
        else:
            pytest.fail("idle connections shut others out")
    finally:
        for idle in lines:
            idle.close()
