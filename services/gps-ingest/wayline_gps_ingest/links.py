"""Opens a receiver by its URL: a serial line, a TCP or UDP peer, gpsd. Each gives what was said."""

import errno
import json
import socket
import termios
import time
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from typing import Any, NamedTuple, Protocol
from urllib.parse import SplitResult, parse_qsl, urlsplit

import msgspec
import serial

from wayline.errors import InputError
from wayline.framing import SentenceSplitter
from wayline.inputs import Sentence
from wayline.live_sources import LiveNmea, LiveRaw
from wayline_gps_ingest.baud import BaudSearch, UbxEar, is_sound
from wayline_gps_ingest.gpsd import GpsdReport
from wayline_gps_ingest.raw.ubx_frames import UbxBytes, UbxSplitter

READ_S = 0.2
SILENT_S = 5.0
"""A peer that says nothing this long is taken for dead and called again."""
CONNECT_S = 2.0
CHUNK_BYTES = 65_536
REPORT_MAX_BYTES = 262_144
"""More than gpsd's longest report, with all satellites of the sky."""
GPSD_PORT = 2947
KEEPALIVE = (
    (socket.TCP_KEEPIDLE, 1),
    (socket.TCP_KEEPINTVL, 1),
    (socket.TCP_KEEPCNT, 3),
)
"""In seconds: a peer that lost its power is noticed, and called again when it is back."""
REFUSALS: dict[int | None, str] = {
    errno.ENOENT: "is not there",
    errno.ENODEV: "is not there",
    errno.ENXIO: "is not there",
    errno.EIO: "is not there",
    errno.EACCES: "may not be read, its group (dialout) is needed",
    errno.EAGAIN: "in use by another program",
    errno.EBUSY: "in use by another program",
}
"""Of a device, for people."""
UBX_ONLY = "u-blox binary only"
"""Of a receiver that is understood but says nothing in NMEA."""
EXAMPLES = {"tcp": "tcp://host:10110", "udp": "udp://:10110", "gpsd": "gpsd://host:2947"}


class Splitter(Protocol):
    """Bytes of one connection in, in whatever pieces they come, whole parts out."""

    def feed(self, chunk: bytes) -> list[Any]:
        """The parts that a chunk completes."""
        ...

    def end(self) -> list[Any]:
        """What the last bytes held, now that no more will come."""
        ...


class Speech(NamedTuple):
    """What a receiver speaks."""

    splitter: Callable[[], Splitter]
    is_sound: Callable[[Any], bool]
    """Whether a part was read at the right rate."""
    received: Callable[[int, Any], msgspec.Struct]
    """A part with its receipt, as its core takes it."""


NMEA = Speech(SentenceSplitter, is_sound, Sentence)


def ubx_speech(faults: Counter[str]) -> Speech:
    """UBX, of which a message proves itself by its checksum; `faults` counts what does not."""
    return Speech(lambda: UbxSplitter(faults), lambda _: True, UbxBytes)


class Heard(NamedTuple):
    """What came within `READ_S`."""

    size_bytes: int
    lines: list[Any]
    """Sentences or reports as text, UBX messages as bytes."""


class Link(Protocol):
    """Where lines come from."""

    patience_s: float
    """A link that is silent for longer is opened anew."""

    def read(self) -> Heard:
        """What has come within `READ_S`. Raises OSError at its end."""
        ...

    @property
    def note(self) -> str | None:
        """What else is known of the link, for people."""
        ...


class Address(NamedTuple):
    """How a receiver is reached."""

    open: Callable[[], AbstractContextManager[Link]]
    line: Callable[[int, Any], msgspec.Struct]
    """A line with its receipt, as its core takes it."""


def address_of(source: LiveNmea | LiveRaw, speech: Speech = NMEA) -> Address:
    """How to reach a receiver and what it speaks, where that is not gpsd.

    Raises InputError for a URL that lacks something.
    """
    parts = urlsplit(source.url)
    if parts.scheme == "serial":
        if not parts.path.strip("/"):
            raise InputError(source.url, "names no device", "give serial:///dev/ttyUSB0")
        # kept while the device comes and goes, so that its rate is known when it is back
        search = BaudSearch()
        rate_bps = _baud_of(source, parts)
        return Address(lambda: _serial(parts.path, rate_bps, search, speech), speech.received)
    host, port = _host_and_port(source.url, parts)
    if parts.scheme == "udp":
        return Address(lambda: _udp(host, port, speech), speech.received)
    if parts.scheme == "gpsd":
        return Address(lambda: _gpsd(host, port, parts.path), GpsdReport)
    return Address(lambda: _tcp(host, port, speech), speech.received)


def _baud_of(source: LiveNmea | LiveRaw, parts: SplitResult) -> int | None:
    """The rate that the URL or else the table fixes."""
    options = dict(parse_qsl(parts.query, keep_blank_values=True))
    told = options.pop("baud", None)
    if options:
        raise InputError(source.url, f"unknown option {min(options)}", "baud is the only one")
    if told is None:
        return source.baud
    if not told.isascii() or not told.isdigit() or int(told) == 0:
        raise InputError(source.url, f"baud {told!r} is no rate", "give e.g. ?baud=9600")
    return int(told)


def _host_and_port(url: str, parts: SplitResult) -> tuple[str, int]:
    try:
        port = parts.port or (GPSD_PORT if parts.scheme == "gpsd" else None)
        host = (parts.hostname or "").encode("idna").decode()
    except ValueError:
        host, port = "", None
    if port is None or (parts.scheme != "udp" and not host):
        raise InputError(url, "lacks a host or a port", f"give e.g. {EXAMPLES[parts.scheme]}")
    return host, port


class SerialLink:
    """A serial line; without a fixed rate it is read at the rates of a search."""

    patience_s = SILENT_S

    def __init__(
        self, line: serial.Serial, search: BaudSearch | None, speech: Speech = NMEA
    ) -> None:
        self._line = line
        self._search = search
        self._speech = speech
        self._splitter = speech.splitter()
        self._ubx = UbxEar()
        self._is_ubx = False

    @property
    def note(self) -> str:
        """The rate, and what was understood at it."""
        rate = f"{self._line.baudrate} baud"
        if self._search is not None and not self._search.is_found:
            return f"{rate} being tried"
        return f"{rate}, {UBX_ONLY}" if self._is_ubx else rate

    def read(self) -> Heard:
        """What is there, else the first byte that comes."""
        try:
            chunk = bytes(self._line.read(max(1, self._line.in_waiting)))
            lines = self._splitter.feed(chunk) if chunk else []
            self._judge(chunk, lines)
        except (termios.error, ValueError) as error:
            raise OSError(*error.args) from None
        return Heard(len(chunk), lines)

    def _judge(self, chunk: bytes, lines: list[Any]) -> None:
        """Learn from what came whether the rate is right."""
        is_understood = any(map(self._speech.is_sound, lines))
        is_ubx = not is_understood and self._ubx.hears(chunk)
        if is_understood or is_ubx:
            self._is_ubx = is_ubx
        if self._search is None:
            return
        if self._search.heard(time.monotonic(), chunk, sound=is_understood or is_ubx):
            self._line.baudrate = self._search.rate_bps
            self._splitter = self._speech.splitter()


class StreamLink:
    """A connection that carries what a receiver sends."""

    patience_s = SILENT_S
    note = None

    def __init__(self, peer: socket.socket, speech: Speech) -> None:
        self._peer = peer
        self._splitter = speech.splitter()

    def read(self) -> Heard:
        """The next bytes."""
        chunk = _received(self._peer)
        return Heard(len(chunk), self._splitter.feed(chunk) if chunk else [])


class DatagramLink:
    """A port that datagrams come to; whoever sends them is free to be silent."""

    patience_s = float("inf")
    note = None

    def __init__(self, port: socket.socket, speech: Speech) -> None:
        self._port = port
        self._speech = speech

    def read(self) -> Heard:
        """The next datagram, which tears nothing apart."""
        try:
            chunk = self._port.recv(CHUNK_BYTES)
        except TimeoutError:
            return Heard(0, [])
        splitter = self._speech.splitter()
        return Heard(len(chunk), [*splitter.feed(chunk), *splitter.end()])


class GpsdLink:
    """A connection to gpsd: one report a line."""

    patience_s = SILENT_S
    note = None

    def __init__(self, peer: socket.socket) -> None:
        self._peer = peer
        self._rest = b""

    def read(self) -> Heard:
        """The reports that the next bytes complete."""
        chunk = _received(self._peer)
        *lines, self._rest = (self._rest + chunk).split(b"\n")
        self._rest = self._rest[-REPORT_MAX_BYTES:]
        return Heard(
            len(chunk), [line.decode("utf-8", "replace") for line in lines if line.strip()]
        )


def _received(peer: socket.socket) -> bytes:
    try:
        chunk = peer.recv(CHUNK_BYTES)
    except TimeoutError:
        return b""
    if not chunk:
        raise ConnectionError("the peer hung up")
    return chunk


@contextmanager
def _serial(
    device: str, rate_bps: int | None, search: BaudSearch, speech: Speech
) -> Iterator[Link]:
    search.start()
    try:
        # locked, because two readers would each get half of every sentence
        line = serial.Serial(device, rate_bps or search.rate_bps, timeout=READ_S, exclusive=True)
    except (OSError, termios.error, ValueError) as error:
        raise OSError(_why_not(error)) from None
    with line:
        yield SerialLink(line, search if rate_bps is None else None, speech)


def _why_not(error: Exception) -> str:
    """Why a device cannot be opened, for people."""
    number = getattr(error, "errno", None)
    return REFUSALS.get(number, str(error))


@contextmanager
def _tcp(host: str, port: int, speech: Speech) -> Iterator[Link]:
    with _connection(host, port) as peer:
        yield StreamLink(peer, speech)


@contextmanager
def _gpsd(host: str, port: int, device: str) -> Iterator[Link]:
    watch = {"enable": True, "json": True} | ({"device": device} if device.strip("/") else {})
    with _connection(host, port) as peer:
        peer.sendall(f"?WATCH={json.dumps(watch)};\n".encode())
        yield GpsdLink(peer)


@contextmanager
def _connection(host: str, port: int) -> Iterator[socket.socket]:
    with socket.create_connection((host, port), timeout=CONNECT_S) as peer:
        peer.setsockopt(socket.SOL_SOCKET, socket.SO_KEEPALIVE, 1)
        for option, seconds in KEEPALIVE:
            peer.setsockopt(socket.IPPROTO_TCP, option, seconds)
        peer.settimeout(READ_S)
        yield peer


@contextmanager
def _udp(host: str, port: int, speech: Speech) -> Iterator[Link]:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as own:
        own.bind((host, port))
        own.settimeout(READ_S)
        yield DatagramLink(own, speech)
