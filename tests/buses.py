"""Adapters that misbehave, for tests of what reads a bus."""

import logging
import threading
import time
from collections.abc import Callable
from typing import Any

import can

log = logging.getLogger(__name__)

WAIT_S = 20.0
BACK_S = 2.0
TRIES = 3


class DriverBugError(Exception):
    """What nobody expects."""


def message(identifier: int = 0x100, data: bytes = b"\x01\x02", **more: Any) -> can.Message:
    """A data frame stamped now."""
    return can.Message(
        timestamp=more.pop("timestamp", time.time()),
        arbitration_id=identifier,
        data=data,
        is_extended_id=more.pop("is_extended_id", identifier > 0x7FF),
        **more,
    )


def await_true(condition: Callable[[], bool], what: str) -> float:
    """Seconds until a condition holds; fails where it does not."""
    start_s = time.monotonic()
    while not condition():
        assert time.monotonic() - start_s < WAIT_S, f"not within {WAIT_S:g} s: {what}"
        time.sleep(0.005)
    return time.monotonic() - start_s


def back_within(
    bar_s: float, name: str, fault: Callable[[], None], back_s: Callable[[], float]
) -> None:
    """After a fault that has ended when its call returns, data come in time."""
    seen_s = []
    for _ in range(TRIES):
        fault()
        seen_s.append(back_s())
        log.info("%s: back after %.2f s", name, seen_s[-1])
        if seen_s[-1] < bar_s:
            return
    raise AssertionError(f"{name}: back only after {seen_s} s")


class Adapter:
    """A device that is plugged, unplugged and broken at will; opened as often as one likes.

    `recv` says what a read gives: a message or rubbish, or raises. By default a frame every 10 ms.
    """

    def __init__(self) -> None:
        self.open_error: Exception | None = None
        self.recv: Callable[[float | None], Any] = self.speak
        self.opened: list[FakeBus] = []
        self.hang = threading.Event()
        self.hang.set()

    def speak(self, timeout: float | None) -> can.Message:
        """A frame after 10 ms."""
        time.sleep(0.01)
        return message()

    def open(self, source: object) -> can.BusABC:
        """What python-can does with a configuration."""
        if self.open_error is not None:
            raise self.open_error
        self.opened.append(FakeBus(self))
        return self.opened[-1]


class FakeBus(can.BusABC):
    """One opening of an adapter."""

    def __init__(self, adapter: Adapter) -> None:
        self._adapter = adapter
        self.sent: list[can.Message] = []
        self.filters_set: list[Any] = []
        self.channel_info = "fake"
        super().__init__(channel="fake")

    @property
    def is_shut(self) -> bool:
        """Whether it was closed."""
        return self._is_shutdown

    def _apply_filters(self, filters: Any) -> None:
        self.filters_set.append(filters)

    def _recv_internal(self, timeout: float | None) -> tuple[Any, bool]:
        return self._adapter.recv(timeout), True

    def send(self, msg: can.Message, timeout: float | None = None) -> None:
        """Keep it."""
        self.sent.append(msg)
