"""What strangers try at the doors of the services: none gets in, and nobody is kept out by them."""

import base64
import contextlib
import functools
import hashlib
import http.client
import json
import socket
import time
import urllib.error
import urllib.request
from collections.abc import Iterator

import pytest

from besieged import await_true
from street import write_route
from wayline.http_deadlines import HEADER_WITHIN_S
from wayline.http_guard import TOKEN_PROTOCOL
from wayline_cli.local_system import LocalSystem

TOKEN, RIDER = "correct-horse-battery-staple", "a-token-for-riders"
SERVICES = ("eta", "dashboard")
WAIT_S = 30.0
ANSWER_S = 2.0
"""Whoever asks properly gets an answer so soon, whatever goes on."""
SLOW = 200


@pytest.fixture(scope="module")
def system(tmp_path_factory: pytest.TempPathFactory) -> Iterator[LocalSystem]:
    """Services with tokens, as they stand behind a proxy or with TLS."""
    folder = tmp_path_factory.mktemp("doors")
    route = write_route(folder / "street.geojson")
    options = {"vehicles": ["*"], "routes": [str(route)]}
    with LocalSystem(folder, **options, database_url=f"sqlite:///{folder / 'w.db'}") as system:
        kept = hashlib.sha256(RIDER.encode()).hexdigest()
        with system.config.open("a") as config:
            tokens = f'"{TOKEN}", {{ sha256 = "{kept}", scope = "public" }}'
            config.write(f"[http]\ntokens = [{tokens}]\n")
        system.start_router()
        for service in SERVICES:
            system.start(service)
            await_true(functools.partial(is_alive, system, service), f"{service} is alive")
        yield system


def is_alive(system: LocalSystem, service: str) -> bool:
    try:
        return status(system, service, "/livez") == http.client.OK
    except OSError:
        return False


def status(
    system: LocalSystem,
    service: str,
    path: str,
    headers: dict[str, str] | None = None,
    method: str = "GET",
) -> int:
    request = urllib.request.Request(
        f"{system.url(service)}{path}", headers=headers or {}, method=method
    )
    try:
        with urllib.request.urlopen(request, timeout=ANSWER_S) as answer:
            return int(answer.status)
    except urllib.error.HTTPError as error:
        with error:
            return error.code


def raw(system: LocalSystem, service: str, sent: bytes) -> bytes:
    """All that a service answers to some bytes before it closes or falls silent."""
    parts = []
    with socket.create_connection(("127.0.0.1", system.ports[service]), timeout=1.0) as line:
        with contextlib.suppress(ConnectionError):
            line.sendall(sent)
        with contextlib.suppress(TimeoutError, ConnectionError):
            while part := line.recv(65_536):
                parts.append(part)
    return b"".join(parts)


@pytest.mark.parametrize("service", SERVICES)
def test_requests_that_never_end_keep_nobody_waiting_and_end(
    system: LocalSystem, service: str
) -> None:
    half = f"GET /v1/routes HTTP/1.1\r\nHost: localhost\r\nAuthorization: Bearer {TOKEN}\r\n"
    begun = half.encode() + b"Content-Length: 10\r\n\r\nabc"
    with contextlib.ExitStack() as stack:
        lines = []
        for number in range(SLOW):
            line = socket.create_connection(("127.0.0.1", system.ports[service]), timeout=WAIT_S)
            lines.append(stack.enter_context(line))
            line.sendall(half.encode() if number % 2 else begun)
        until_s = time.monotonic() + HEADER_WITHIN_S
        while time.monotonic() < until_s:
            bearer = {"authorization": f"Bearer {TOKEN}"}
            assert status(system, service, "/v1/routes", bearer) == http.client.OK
            time.sleep(0.2)
        for line in lines:
            with contextlib.suppress(ConnectionError):
                while line.recv(65_536):
                    pass


def encoded(token: str) -> str:
    return base64.urlsafe_b64encode(token.encode()).decode().rstrip("=")


FORGED: tuple[dict[str, str], ...] = (
    {},
    {"authorization": ""},
    {"authorization": "Bearer"},
    {"authorization": "Bearer "},
    {"authorization": TOKEN},
    {"authorization": f"Basic {TOKEN}"},
    {"authorization": f"Bearer {TOKEN}x"},
    {"authorization": f"Bearer {TOKEN[:-1]}"},
    {"authorization": f"Bearer {TOKEN.upper()}"},
    {"authorization": f"Bearer {encoded(TOKEN)}"},
    {"authorization": f"Bearer {hashlib.sha256(TOKEN.encode()).hexdigest()}"},
    {"authorization": f"Bearer {hashlib.sha256(RIDER.encode()).hexdigest()}"},
    {"authorization": f"Bearer x, Bearer {TOKEN}"},
    {"cookie": f"token={TOKEN}", "x-forwarded-for": "127.0.0.1"},
    {"sec-websocket-protocol": f"{TOKEN_PROTOCOL}{TOKEN}"},
)


@pytest.mark.parametrize("headers", FORGED, ids=str)
def test_a_forged_token_opens_nothing(system: LocalSystem, headers: dict[str, str]) -> None:
    for service, path in (("eta", "/v1/vehicles"), ("dashboard", "/v1/view"), ("eta", "/metrics")):
        assert status(system, service, path, headers) == http.client.UNAUTHORIZED
        assert status(system, service, f"{path}?token={TOKEN}", headers) in {401, 422}


def test_a_riders_token_opens_what_riders_need(system: LocalSystem) -> None:
    rider = {"authorization": f"Bearer {RIDER}"}
    assert status(system, "eta", "/v1/stops", rider) == http.client.OK
    assert status(system, "eta", "/v1/vehicles", rider) == http.client.FORBIDDEN
    for method in ("POST", "PUT", "DELETE", "PATCH"):
        assert status(system, "eta", "/v1/stops", rider, method) == http.client.FORBIDDEN


UP = ("..", "%2e%2e", "..%2f..", "%2e%2e%2f%2e%2e", "....", "..%5c..", "%252e%252e", "..;", ".%2e")
ROOTS = ("", "assets/", "docs/assets/")


@pytest.mark.parametrize("root", ROOTS)
@pytest.mark.parametrize("up", UP)
def test_no_path_leads_out_of_the_page(system: LocalSystem, root: str, up: str) -> None:
    for file in ("etc/passwd", "pyproject.toml", "wayline.toml"):
        path = "/".join([up] * 6)
        request = (
            f"GET /{root}{path}/{file} HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n"
        )
        answer = raw(system, "dashboard", request.encode())
        assert answer.startswith((b"HTTP/1.1 4", b"HTTP/1.1 3"))
        assert b"root:" not in answer
        assert b"tokens" not in answer


HEAD = b"GET /v1/vehicles HTTP/1.1\r\nHost: localhost\r\n"
SECOND = b"GET /livez HTTP/1.1\r\nHost: localhost\r\n\r\n"
CHUNKED = b"Transfer-Encoding: chunked\r\n"
LENGTH = b"Content-Length: %d\r\n" % len(SECOND)
SMUGGLED = (
    HEAD + LENGTH + CHUNKED + b"\r\n0\r\n\r\n" + SECOND,
    HEAD + CHUNKED + LENGTH + b"\r\n0\r\n\r\n" + SECOND,
    HEAD + b"Content-Length: 0\r\n" + LENGTH + b"\r\n" + SECOND,
    HEAD + LENGTH + b"Content-Length: 0\r\n\r\n" + SECOND,
    HEAD + b"Content-Length: 0, 5\r\n\r\n" + SECOND,
    HEAD + b"Content-Length: +0\r\n\r\n" + SECOND,
    HEAD + b"Content-Length: -1\r\n\r\n" + SECOND,
    HEAD + b"Content-Length: 0x0\r\n\r\n" + SECOND,
    HEAD + b"Content-Length: \r\n\r\n" + SECOND,
    HEAD + b"Content-Length : 0\r\n\r\n" + SECOND,
    HEAD + b"Transfer-Encoding: xchunked\r\n\r\n" + SECOND,
    HEAD + b"Transfer-Encoding : chunked\r\n\r\n0\r\n\r\n" + SECOND,
    HEAD + b"Transfer-Encoding: chunked, identity\r\n\r\n0\r\n\r\n" + SECOND,
    HEAD + b"Transfer-Encoding: identity, chunked\r\n\r\n0\r\n\r\n" + SECOND,
    HEAD + CHUNKED + b"\r\nzz\r\n" + SECOND,
    HEAD + CHUNKED + b"\r\n-1\r\n" + SECOND,
    HEAD + b"X: a\r\n\x00Y: b\r\n\r\n" + SECOND,
    b"GET /v1/vehicles HTTP/1.1\nHost: localhost\n\x0bX: y\n\n" + SECOND,
    b"GET  /v1/vehicles HTTP/1.1\r\nHost: localhost\r\n\r\n" + SECOND,
    b"GET /v1/vehicles\r\nX HTTP/1.1\r\nHost: localhost\r\n\r\n" + SECOND,
    b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03" + SECOND,
)


@pytest.mark.parametrize("sent", SMUGGLED, ids=range(len(SMUGGLED)))
def test_a_request_hidden_in_another_is_not_answered(system: LocalSystem, sent: bytes) -> None:
    answer = raw(system, "eta", sent)
    assert answer.startswith((b"HTTP/1.1 400", b"HTTP/1.1 401"))
    assert answer.count(b"HTTP/1.1 ") == 1
    assert b'"alive"' not in answer


def test_what_is_too_large_is_refused(system: LocalSystem) -> None:
    large = HEAD + b"X-Large: " + b"a" * 200_000 + b"\r\n\r\n"
    assert b"200 OK" not in raw(system, "eta", large)
    many = HEAD + b"".join(b"X-%d: a\r\n" % number for number in range(20_000)) + b"\r\n"
    assert b"200 OK" not in raw(system, "eta", many)
    body = b"POST /v1/stops HTTP/1.1\r\nHost: localhost\r\nContent-Length: 9999999999\r\n\r\n"
    assert raw(system, "eta", body).startswith(b"HTTP/1.1 4")
    assert is_alive(system, "eta")


@pytest.mark.parametrize("origin", ["https://evil.example", "null", "http://localhost.evil"])
def test_another_page_is_told_nothing(system: LocalSystem, origin: str) -> None:
    sent = (
        f"OPTIONS /v1/vehicles HTTP/1.1\r\nHost: localhost\r\nOrigin: {origin}\r\n"
        "Access-Control-Request-Method: GET\r\nConnection: close\r\n\r\n"
    )
    assert b"access-control-allow-origin" not in raw(system, "eta", sent.encode()).lower()


def test_sockets_without_a_token_are_refused_however_many(system: LocalSystem) -> None:
    ask = (
        "GET /v1/live HTTP/1.1\r\nHost: localhost\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
        f"Sec-WebSocket-Key: {base64.b64encode(b'0' * 16).decode()}\r\n"
        "Sec-WebSocket-Version: 13\r\n\r\n"
    )
    for _ in range(100):
        assert raw(system, "dashboard", ask.encode()).startswith(b"HTTP/1.1 401")
    assert is_alive(system, "dashboard")


def test_a_refusal_is_a_problem_that_tells_nothing(system: LocalSystem) -> None:
    answer = raw(system, "eta", HEAD + b"Connection: close\r\n\r\n")
    head, _, body = answer.partition(b"\r\n\r\n")
    assert b"application/problem+json" in head
    assert json.loads(body)["detail"] == "send Authorization: Bearer <token>"
