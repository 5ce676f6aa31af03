"""A gpsd on TCP, as gps-ingest reads it from `gpsd://host:port`."""

import queue
import socketserver
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import msgspec

from unit.gps_ingest.receiver import fixes
from wayline.live_sources import LiveNmea
from wayline.messages import Message
from wayline_gps_ingest.gpsd import GpsdCore
from wayline_gps_ingest.receivers import Receiver

OLD = Path(__file__).parents[2] / "replay" / "logs" / "gpsd-old-alt" / "gpsd.jsonl"
VERSION = b'{"class":"VERSION","release":"3.17","rev":"3.17","proto_major":3,"proto_minor":12}\r\n'
PATIENCE_S = 10.0


@contextmanager
def gpsd_saying(reports: bytes) -> Iterator[int]:
    """The port of a server that greets, waits to be asked and reports."""

    class Gpsd(socketserver.StreamRequestHandler):
        def handle(self) -> None:
            self.wfile.write(VERSION)
            assert self.rfile.readline().startswith(b"?WATCH")
            self.wfile.write(reports)
            self.rfile.readline()

    with socketserver.ThreadingTCPServer(("127.0.0.1", 0), Gpsd) as server:
        thread = threading.Thread(target=server.serve_forever)
        thread.start()
        yield server.server_address[1]
        server.shutdown()
        thread.join()


def test_an_old_gpsd_tells_the_altitude_as_alt() -> None:
    """Up to 3.18 (Debian 10, Ubuntu 18.04) it is above the sea and there is no other."""
    lines: queue.SimpleQueue[msgspec.Struct] = queue.SimpleQueue()
    stop, core = threading.Event(), GpsdCore()
    messages: list[Message] = []
    with gpsd_saying(OLD.read_bytes()) as port:
        receiver = Receiver("gps-ingest", LiveNmea(url=f"gpsd://127.0.0.1:{port}"))
        reading = threading.Thread(target=receiver.run, args=(lines.put, stop))
        reading.start()
        while len(messages) < 2:
            messages += core.handle(lines.get(timeout=PATIENCE_S), "gps-ingest")
        stop.set()
        reading.join()
    assert [(fix.valid, fix.mode, fix.alt_m) for fix in fixes(messages)] == [(True, 3, 449.5)] * 2
    assert core.bad_input == 0
