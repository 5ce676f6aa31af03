"""Runs an app in a thread beside the service's own work."""

import socket
import ssl
import threading
from pathlib import Path

import uvicorn
from starlette.applications import Starlette
from starlette.types import ASGIApp

from wayline.errors import InputError
from wayline.http_deadlines import DeadlineProtocol
from wayline.http_settings import HttpSettings, check_exposure

GRACE_S = 2
"""How long open requests and pages may take to end when the service stops."""
START_S = 10.0
MESSAGE_MAX_BYTES = 65_536
"""Pages send next to nothing; a larger WebSocket message is not one of ours."""


class HttpServer:
    """Listens from construction on, serves from `start` to `stop`; a context manager too.

    Raises InputError where the settings are too open, the address cannot be had or the
    certificate cannot be read.
    """

    def __init__(self, app: ASGIApp, settings: HttpSettings, default_port: int = 0) -> None:
        check_exposure(settings)
        _check_certificate(settings)
        port = default_port if settings.port is None else settings.port
        self._settings = settings
        self._socket = _listen(settings.host, port)
        self._server = uvicorn.Server(_config(app, settings))
        if isinstance(app, Starlette):
            # streams that never end by themselves would be cut off, with a traceback, after GRACE_S
            app.state.is_ending = lambda: self._server.should_exit
        self._thread = threading.Thread(target=self._serve, name="http", daemon=True)
        self._ended = threading.Event()

    @property
    def port(self) -> int:
        """The port that it listens on."""
        return int(self._socket.getsockname()[1])

    @property
    def url(self) -> str:
        """Where it answers, without a slash at the end."""
        scheme = "https" if self._settings.tls_cert else "http"
        host = self._settings.host
        return f"{scheme}://{f'[{host}]' if ':' in host else host}:{self.port}"

    def start(self) -> None:
        """Serve; returns when requests are answered. A server that fails to start raises."""
        self._thread.start()
        waited_s = 0.0
        while not self._server.started:
            if self._ended.wait(0.01) or waited_s > START_S:
                raise RuntimeError(f"the server of {self.url} did not start; see its log")
            waited_s += 0.01

    def stop(self) -> None:
        """End open pages and requests within a grace time, then release the port."""
        self._server.should_exit = True
        if self._thread.is_alive():
            self._thread.join(GRACE_S + START_S)
        self._socket.close()

    def __enter__(self) -> "HttpServer":
        self.start()
        return self

    def __exit__(self, *_: object) -> None:
        self.stop()

    def _serve(self) -> None:
        try:
            self._server.run(sockets=[self._socket])
        finally:
            self._ended.set()


def _config(app: ASGIApp, settings: HttpSettings) -> uvicorn.Config:
    return uvicorn.Config(
        app,
        log_config=None,
        http=DeadlineProtocol,
        access_log=False,
        server_header=False,
        proxy_headers=settings.behind_proxy,
        forwarded_allow_ips="*" if settings.behind_proxy else None,
        ssl_certfile=settings.tls_cert,
        ssl_keyfile=settings.tls_key,
        timeout_graceful_shutdown=GRACE_S,
        # its send waits while a slow reader's socket is full, which is what coalescing rests on
        ws="websockets-sansio",
        ws_max_size=MESSAGE_MAX_BYTES,
    )


def _listen(host: str, port: int) -> socket.socket:
    try:
        family, _, _, _, address = socket.getaddrinfo(
            host, port, type=socket.SOCK_STREAM, flags=socket.AI_PASSIVE
        )[0]
        listening = socket.create_server(address, family=family)
    except OSError as error:
        # create_server adds the address in brackets, which `where` says already
        reason = (error.strerror or str(error)).partition(" (while")[0]
        raise InputError(
            f"http {host}:{port}",
            f"cannot listen ({reason})",
            "stop what uses the port or set another http.port or http.host",
        ) from None
    # head and body are two writes: the second would wait 40 ms for the first one's acknowledgement
    listening.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    return listening


def _check_certificate(settings: HttpSettings) -> None:
    if settings.tls_cert is None or settings.tls_key is None:
        return
    for path in (settings.tls_cert, settings.tls_key):
        if not Path(path).is_file():
            raise InputError(path, "no such file", "correct http.tls_cert or http.tls_key")
    try:
        context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
        context.load_cert_chain(settings.tls_cert, settings.tls_key)
    except (ssl.SSLError, OSError) as error:
        raise InputError(
            settings.tls_cert,
            f"cannot be used with {settings.tls_key} ({error})",
            "give a PEM certificate chain and its own key",
        ) from None
