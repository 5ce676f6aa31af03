import http.client
import socket
import ssl
import subprocess
import threading
import urllib.error
import urllib.request
from pathlib import Path

import pytest
from starlette.applications import Starlette
from starlette.requests import Request
from starlette.responses import PlainTextResponse
from starlette.routing import Route

from wayline.errors import InputError
from wayline.http_server import HttpServer
from wayline.http_settings import HttpSettings

TOKEN = "correct-horse-battery"
ANY_PORT = HttpSettings(port=0)


def make_app() -> Starlette:
    def hello(request: Request) -> PlainTextResponse:
        return PlainTextResponse(f"{request.url.scheme} {request.client and request.client.host}")

    return Starlette(routes=[Route("/hello", hello)])


def get(url: str, headers: dict[str, str] | None = None) -> str:
    request = urllib.request.Request(url, headers=headers or {})
    with urllib.request.urlopen(request, timeout=5.0) as answer:
        return str(answer.read().decode())


def test_it_answers_on_the_port_that_it_reports() -> None:
    with HttpServer(make_app(), ANY_PORT) as server:
        assert server.port > 0
        assert get(f"{server.url}/hello") == "http 127.0.0.1"


def test_it_takes_the_services_own_port_unless_told_otherwise() -> None:
    with socket.create_server(("127.0.0.1", 0)) as probe:
        free = probe.getsockname()[1]
    server = HttpServer(make_app(), HttpSettings(), default_port=free)
    assert server.port == free
    server.stop()


def test_stop_frees_the_port_and_the_thread() -> None:
    server = HttpServer(make_app(), ANY_PORT)
    server.start()
    url = server.url
    server.stop()
    with pytest.raises(urllib.error.URLError):
        get(f"{url}/hello")
    assert "http" not in [thread.name for thread in threading.enumerate()]


def test_a_port_in_use_is_said_with_the_mend() -> None:
    server = HttpServer(make_app(), ANY_PORT)
    with pytest.raises(InputError, match=r"cannot listen \(Address already in use\); stop what"):
        HttpServer(make_app(), HttpSettings(port=server.port))
    server.stop()


def test_it_refuses_to_listen_to_strangers_without_tokens() -> None:
    with pytest.raises(InputError, match="without tokens"):
        HttpServer(make_app(), HttpSettings(host="0.0.0.0", port=0))


def test_a_proxys_word_is_believed_only_when_there_is_one() -> None:
    forwarded = {"x-forwarded-proto": "https", "x-forwarded-for": "203.0.113.9"}
    proxied = HttpSettings(port=0, behind_proxy=True)
    with HttpServer(make_app(), proxied) as server:
        assert get(f"{server.url}/hello", forwarded) == "https 203.0.113.9"


@pytest.fixture
def certificate(tmp_path: Path) -> tuple[Path, Path]:
    cert, key = tmp_path / "cert.pem", tmp_path / "key.pem"
    command = ["openssl", "req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:P-256"]
    command += ["-nodes", "-days", "2", "-subj", "/CN=localhost", "-addext"]
    command += ["subjectAltName=DNS:localhost,IP:127.0.0.1", "-keyout", str(key), "-out", str(cert)]
    try:
        subprocess.run(command, check=True, capture_output=True)
    except FileNotFoundError:
        pytest.skip("openssl is not installed")
    return cert, key


def test_it_speaks_tls(certificate: tuple[Path, Path]) -> None:
    cert, key = certificate
    settings = HttpSettings(port=0, tls_cert=str(cert), tls_key=str(key))
    with HttpServer(make_app(), settings) as server:
        assert server.url.startswith("https://")
        context = ssl.create_default_context(cafile=str(cert))
        line = http.client.HTTPSConnection("127.0.0.1", server.port, context=context, timeout=5.0)
        line.request("GET", "/hello")
        assert line.getresponse().read() == b"https 127.0.0.1"
        line.close()


def test_a_missing_certificate_is_named(tmp_path: Path) -> None:
    absent = str(tmp_path / "absent.pem")
    with pytest.raises(InputError, match=r"absent\.pem: no such file"):
        HttpServer(make_app(), HttpSettings(port=0, tls_cert=absent, tls_key=absent))


def test_a_file_that_is_no_certificate_is_named(tmp_path: Path) -> None:
    text = tmp_path / "text.pem"
    text.write_text("not a certificate")
    with pytest.raises(InputError, match=r"text\.pem: cannot be used"):
        HttpServer(make_app(), HttpSettings(port=0, tls_cert=str(text), tls_key=str(text)))
