"""Live receivers by URL: a serial line, a TCP or UDP peer, gpsd. Each comes back by itself."""

import socket
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from typing import Protocol
from urllib.parse import urlsplit

import msgspec
import serial

from wayline.errors import InputError
from wayline.framing import split_sentences
from wayline.inputs import Sentence
from wayline.settings import LiveNmea

READ_S = 0.2
SILENT_S = 5.0
"""A stream peer that says nothing this long is taken for dead and called again."""
RETRY_S = (0.2, 0.5, 1.0, 2.0)
LONGEST_LINE = 4096
WATCH = b'?WATCH={"enable":true,"nmea":true};\n'
"""Asks gpsd to pass the receiver's sentences on."""


class Link(Protocol):
    """Where bytes come from."""

    def read(self) -> bytes:
        """What has come within `READ_S`; empty for nothing. Raises OSError at its end."""
        ...


class Receiver:
    """One receiver as a feed of sentences."""

    def __init__(self, name: str, source: LiveNmea) -> None:
        self.name = name
        self._source = source
        self._open = opener(source)
        self._state = "not connected yet"
        self._heard_s: float | None = None

    @property
    def detail(self) -> str:
        """State of the link and age of the last sentence."""
        heard = self._heard_s
        age = "never" if heard is None else f"{time.monotonic() - heard:.0f} s ago"
        return f"{self._source.url}: {self._state}, last sentence {age}"

    def run(self, put: Callable[[msgspec.Struct], None], stop: threading.Event) -> None:
        """Read until told to stop; after a failure connect again, soon and then every 2 s."""
        failures = 0
        while not stop.is_set():
            try:
                with self._open() as link:
                    self._state = "connected"
                    if self._read(link, put, stop):
                        failures = 0
            except OSError as error:
                self._state = f"disconnected ({error})"
            stop.wait(RETRY_S[min(failures, len(RETRY_S) - 1)])
            failures += 1

    def _read(
        self, link: Link, put: Callable[[msgspec.Struct], None], stop: threading.Event
    ) -> bool:
        """Whether anything was heard before the link ended or fell silent."""
        rest = b""
        heard = False
        last_s = time.monotonic()
        while not stop.is_set() and time.monotonic() - last_s < SILENT_S:
            chunk = link.read()
            if not chunk:
                continue
            last_s = time.monotonic()
            heard = True
            *lines, rest = (rest + chunk).replace(b"\r", b"\n").split(b"\n")
            rest = rest[-LONGEST_LINE:]
            arrival_ns = time.time_ns()
            for line in filter(None, lines):
                for sentence in split_sentences(line.decode("latin-1")):
                    self._heard_s = last_s
                    put(Sentence(arrival_ns, sentence))
        self._state = "silent"
        return heard


Opener = Callable[[], AbstractContextManager[Link]]


def opener(source: LiveNmea) -> Opener:
    """How to open a receiver's link. Raises InputError for a URL that lacks something."""
    parts = urlsplit(source.url)
    if parts.scheme == "serial":
        if not parts.path.strip("/"):
            raise InputError(source.url, "names no device", "give serial:///dev/ttyUSB0")
        return lambda: _serial(parts.path, source.baud)
    try:
        port = parts.port
    except ValueError:
        port = None
    if port is None or (parts.scheme != "udp" and not parts.hostname):
        example = "udp://:10110" if parts.scheme == "udp" else f"{parts.scheme}://host:2947"
        raise InputError(source.url, "lacks a host or a port", f"give e.g. {example}")
    host = parts.hostname or "127.0.0.1"
    if parts.scheme == "udp":
        return lambda: _udp(host, port)
    return lambda: _tcp(host, port, WATCH if parts.scheme == "gpsd" else b"")


class SerialLink:
    """A serial line."""

    def __init__(self, line: serial.Serial) -> None:
        self._line = line

    def read(self) -> bytes:
        """What is there, else the first byte that comes."""
        return bytes(self._line.read(max(1, self._line.in_waiting)))


class SocketLink:
    """A connected or bound socket."""

    def __init__(self, peer: socket.socket, *, stream: bool) -> None:
        self._peer = peer
        self._stream = stream

    def read(self) -> bytes:
        """The next bytes or datagram."""
        try:
            chunk = self._peer.recv(65_536)
        except TimeoutError:
            return b""
        if not chunk and self._stream:
            raise OSError("the peer hung up")
        return chunk if self._stream else chunk + b"\n"


@contextmanager
def _serial(device: str, baud: int) -> Iterator[Link]:
    with serial.Serial(device, baud, timeout=READ_S) as line:
        yield SerialLink(line)


@contextmanager
def _tcp(host: str, port: int, greeting: bytes) -> Iterator[Link]:
    with socket.create_connection((host, port), timeout=2.0) as peer:
        peer.settimeout(READ_S)
        peer.sendall(greeting)
        yield SocketLink(peer, stream=True)


@contextmanager
def _udp(host: str, port: int) -> Iterator[Link]:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as peer:
        peer.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        peer.bind((host, port))
        peer.settimeout(READ_S)
        yield SocketLink(peer, stream=False)
