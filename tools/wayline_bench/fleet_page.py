"""A page of the dashboard without a browser: it looks, selects a vehicle and weighs what comes."""

import contextlib
import threading
import time
from collections.abc import Iterator

import msgspec
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import ClientConnection, connect

PATH = "/v1/live"
FIRST_S = 10.0
LARGEST_BYTES = 1 << 28


class Page:
    """The messages of one page's WebSocket: when they came (monotonic clock) and how long."""

    def __init__(self, socket: ClientConnection, vehicle_id: str) -> None:
        self._socket, self._vehicle_id = socket, vehicle_id
        self._is_selected = False
        self.came: list[tuple[float, int]] = []

    def look(self) -> None:
        """Take what comes until the socket is closed; select the vehicle once it is there."""
        with contextlib.suppress(ConnectionClosed):
            for text in self._socket:
                self.came.append((time.monotonic(), len(text)))
                if not self._is_selected and self._vehicle_id in str(text):
                    self._is_selected = True
                    choice = {"vehicle_id": self._vehicle_id}
                    self._socket.send(msgspec.json.encode(choice).decode())

    def bytes_between(self, began_s: float, ended_s: float) -> int:
        """Size of what came meanwhile."""
        return sum(size for at_s, size in self.came if began_s <= at_s < ended_s)


@contextlib.contextmanager
def open_page(url: str, vehicle_id: str) -> Iterator[Page]:
    """A page that looks while the block runs; `url` is the dashboard's."""
    with _connected(url) as socket:
        page = Page(socket, vehicle_id)
        eyes = threading.Thread(target=page.look)
        eyes.start()
        try:
            yield page
        finally:
            socket.close()
            eyes.join()


def snapshot_bytes(url: str) -> int:
    """Size of the first message that a page gets. Raises TimeoutError where none comes."""
    with _connected(url) as socket:
        return len(socket.recv(timeout=FIRST_S))


def _connected(url: str) -> ClientConnection:
    # compressed, as every browser asks for it
    return connect(f"{url.replace('http', 'ws', 1)}{PATH}", max_size=LARGEST_BYTES)
