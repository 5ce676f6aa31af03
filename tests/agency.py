"""An agency as its feed's readers see it: vehicle positions, and a server that tells them."""

import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer

from google.transit import gtfs_realtime_pb2 as realtime

NOON_S = 1_764_504_000
"""30 November 2025, 12:00 UTC."""


@dataclass
class Bus:
    """A vehicle as its agency tells of it."""

    vehicle: str
    lat_deg: float = 38.9
    lon_deg: float = -77.0
    told_s: int = NOON_S
    trip_id: str = ""
    bearing_deg: float | None = None
    speed_mps: float | None = None


def feed_of(buses: list[Bus], told_s: int = NOON_S) -> realtime.FeedMessage:
    """A feed's message."""
    feed = realtime.FeedMessage()
    feed.header.gtfs_realtime_version = "2.0"
    feed.header.timestamp = told_s
    for number, bus in enumerate(buses):
        entity = feed.entity.add(id=str(number))
        told = entity.vehicle
        told.vehicle.id, told.timestamp = bus.vehicle, bus.told_s
        told.position.latitude, told.position.longitude = bus.lat_deg, bus.lon_deg
        if bus.trip_id:
            told.trip.trip_id = bus.trip_id
        if bus.bearing_deg is not None:
            told.position.bearing = bus.bearing_deg
        if bus.speed_mps is not None:
            told.position.speed = bus.speed_mps
    return feed


def payload_of(buses: list[Bus], told_s: int = NOON_S) -> bytes:
    """The bytes of a feed's answer."""
    return feed_of(buses, told_s).SerializeToString()


@dataclass
class Answer:
    """What a server says to one question."""

    body: bytes = b""
    status: int = 200
    headers: dict[str, str] = field(default_factory=dict)


@dataclass
class Asked:
    """A question that has come."""

    path: str
    headers: dict[str, str]


class AgencyServer:
    """A server on loopback; `answer` may be set anew at any time."""

    def __init__(self, port: int, asked: list[Asked]) -> None:
        self.url = f"http://127.0.0.1:{port}/vehicles.pb"
        self.asked = asked
        self.answer: Callable[[Asked], Answer] = lambda _: Answer(status=503)


@contextmanager
def agency_server() -> Iterator[AgencyServer]:
    """A server that ends with the block."""
    asked: list[Asked] = []

    class Handler(BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            question = Asked(self.path, {name.lower(): text for name, text in self.headers.items()})
            asked.append(question)
            answer = server.answer(question)
            self.send_response(answer.status)
            for name, text in answer.headers.items():
                self.send_header(name, text)
            self.send_header("Content-Length", str(len(answer.body)))
            self.end_headers()
            self.wfile.write(answer.body)

        def log_message(self, format: str, *args: object) -> None:  # noqa: A002
            """Say nothing."""

    listening = ThreadingHTTPServer(("127.0.0.1", 0), Handler)
    server = AgencyServer(listening.server_port, asked)
    thread = threading.Thread(target=listening.serve_forever, daemon=True)
    thread.start()
    try:
        yield server
    finally:
        listening.shutdown()
        thread.join()
        listening.server_close()
