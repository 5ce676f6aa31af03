"""Receivers that can be unplugged, stalled and flooded, for a live gps-ingest to read."""

import contextlib
import datetime as dt
import os
import shutil
import socket
import subprocess
import threading
import time
import tty
from collections.abc import Callable, Iterator
from pathlib import Path

from wayline_cli.local_system import free_ports
from wayline_simulator.nmea_text import sentence

RATE_HZ = 5
GPSD = shutil.which("gpsd") or shutil.which("gpsd", path="/usr/sbin:/usr/local/sbin")
"""Debian's place for daemons is not on everybody's path."""


def epoch(index: int) -> bytes:
    """GGA and RMC of an instant, by its number since 1970 at RATE_HZ."""
    now = dt.datetime.fromtimestamp(index // RATE_HZ, dt.UTC)
    clock = f"{now:%H%M%S}.{index % RATE_HZ * 100 // RATE_HZ:02d}"
    place = "4807.03800,N,01131.00000,E"
    bodies = (
        f"GPGGA,{clock},{place},1,08,0.9,545.4,M,46.9,M,,",
        f"GPRMC,{clock},A,{place},022.4,084.4,{now:%d%m%y},,,A",
    )
    return b"".join(sentence(body) + b"\r\n" for body in bodies)


class Talker:
    """Says where it is, RATE_HZ times a second, to whoever listens at the moment."""

    def __init__(self, write: Callable[[bytes], None]) -> None:
        self._write = write
        self._stop = threading.Event()
        self._speaks = threading.Event()
        self._speaks.set()
        self._thread = threading.Thread(target=self._run)
        self._thread.start()

    def _run(self) -> None:
        index = round(time.time() * RATE_HZ)
        while not self._stop.wait(max(index / RATE_HZ - time.time(), 0.0)):
            if self._speaks.is_set():
                self._write(epoch(index))
            index += 1

    @contextlib.contextmanager
    def silenced(self) -> Iterator[None]:
        """Says nothing within the block."""
        self._speaks.clear()
        yield
        self._speaks.set()

    def close(self) -> None:
        """Say no more."""
        self._stop.set()
        self._thread.join()


class Plug:
    """A pseudo-terminal under a name that stays, as udev's names by id do."""

    def __init__(self, device: Path) -> None:
        self.device = device
        self._lock = threading.Lock()
        self._ends: tuple[int, ...] = ()
        self.plug()

    def plug(self) -> None:
        """Plug in: another node, the same name."""
        ends = os.openpty()
        tty.setraw(ends[1])
        os.set_blocking(ends[0], False)
        with self._lock:
            self._ends = ends
        self.device.symlink_to(os.ttyname(ends[1]))

    def unplug(self) -> None:
        """Pull it out, if it is in: readers get an error, the name goes."""
        with self._lock:
            ends, self._ends = self._ends, ()
        for end in ends:
            os.close(end)
        self.device.unlink(missing_ok=True)

    def write(self, data: bytes) -> None:
        """Send; what nobody reads is lost, as on a line."""
        with self._lock, contextlib.suppress(BlockingIOError):
            if self._ends:
                os.write(self._ends[0], data)


class TcpOutlet:
    """A receiver behind a TCP port."""

    def __init__(self) -> None:
        (self.port,) = free_ports(1)
        self._lock = threading.Lock()
        self._peers: list[socket.socket] = []
        self.open()

    def open(self) -> None:
        """Accept whoever calls."""
        self._server = socket.create_server(("127.0.0.1", self.port))
        self._thread = threading.Thread(target=self._accept, args=(self._server,))
        self._thread.start()

    def _accept(self, server: socket.socket) -> None:
        with contextlib.suppress(OSError):
            while True:
                peer, _ = server.accept()
                with self._lock:
                    self._peers.append(peer)

    def write(self, data: bytes) -> None:
        """Send to everybody who is connected."""
        with self._lock:
            for peer in self._peers:
                with contextlib.suppress(OSError):
                    peer.sendall(data)

    def half_close(self) -> None:
        """Say to everybody that no more will come, and leave the connections as they are."""
        with self._lock:
            for peer in self._peers:
                # some hung up long ago
                with contextlib.suppress(OSError):
                    peer.shutdown(socket.SHUT_WR)

    def close(self) -> None:
        """Hang up and accept nobody."""
        # wakes the thread that accepts, which closing alone does not
        self._server.shutdown(socket.SHUT_RDWR)
        self._server.close()
        self._thread.join()
        with self._lock:
            for peer in self._peers:
                peer.close()
            self._peers.clear()


class UdpOutlet:
    """A receiver that sends a datagram an epoch."""

    def __init__(self) -> None:
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
            probe.bind(("127.0.0.1", 0))
            self.port = int(probe.getsockname()[1])

    def write(self, data: bytes) -> None:
        """Send; nobody there is no reason to stop."""
        with contextlib.suppress(ConnectionRefusedError):
            self._socket.sendto(data, ("127.0.0.1", self.port))

    def close(self) -> None:
        """End."""
        self._socket.close()


class Gpsd:
    """A real gpsd on a pseudo-terminal, on a port of its own."""

    def __init__(self, plug: Plug) -> None:
        (self.port,) = free_ports(1)
        self._plug = plug
        self._process: subprocess.Popen[bytes] | None = None

    def start(self) -> None:
        """Start it, without a database of processes or a control socket."""
        assert GPSD is not None
        self._process = subprocess.Popen(
            (GPSD, "-N", "-n", "-b", "-S", str(self.port), str(self._plug.device.resolve())),
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )

    def kill(self) -> None:
        """End it as a crash would."""
        if self._process is not None:
            self._process.kill()
            self._process.wait()
