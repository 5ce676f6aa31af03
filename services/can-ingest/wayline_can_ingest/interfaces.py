"""Live CAN interfaces through python-can; each comes back by itself."""

import threading
import time
from collections.abc import Callable
from typing import Any

import can
import msgspec

from wayline.inputs import Frame
from wayline.settings import LiveCan

READ_S = 0.2
RETRY_S = (0.2, 0.5, 1.0, 2.0)


class Interface:
    """One bus as a feed of frames."""

    can_wait = False

    def __init__(self, name: str, source: LiveCan) -> None:
        self.name = name
        self._source = source
        self._state = "not opened yet"
        self._frames = 0

    @property
    def detail(self) -> str:
        """State of the interface and how many frames came."""
        return (
            f"{self._source.interface} {self._source.channel}: {self._state}, {self._frames} frames"
        )

    def run(self, put: Callable[[msgspec.Struct], None], stop: threading.Event) -> None:
        """Read until told to stop; after a failure open again, soon and then every 2 s."""
        failures = 0
        while not stop.is_set():
            before = self._frames
            try:
                with self._open() as bus:
                    self._state = "open"
                    self._read(bus, put, stop)
            except (can.CanError, OSError) as error:
                self._state = f"closed ({error})"
            failures = 0 if self._frames > before else failures + 1
            stop.wait(RETRY_S[min(failures, len(RETRY_S) - 1)])

    def _open(self) -> can.BusABC:
        options: dict[str, Any] = {}
        if self._source.bitrate is not None:
            options["bitrate"] = self._source.bitrate
        return can.Bus(interface=self._source.interface, channel=self._source.channel, **options)

    def _read(
        self, bus: can.BusABC, put: Callable[[msgspec.Struct], None], stop: threading.Event
    ) -> None:
        channel = str(self._source.channel)
        while not stop.is_set():
            message = bus.recv(READ_S)
            if message is None or message.is_error_frame or message.is_remote_frame:
                continue
            self._frames += 1
            put(
                Frame(
                    _t_ns(message.timestamp),
                    channel,
                    message.arbitration_id,
                    message.is_extended_id,
                    bytes(message.data),
                )
            )


def _t_ns(timestamp_s: float) -> int:
    """Unix time of a frame; interfaces that count from elsewhere get the time of their arrival."""
    now_ns = time.time_ns()
    t_ns = round(timestamp_s * 1e6) * 1000
    return t_ns if abs(now_ns - t_ns) < 60_000_000_000 else now_ns
