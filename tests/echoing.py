"""Services whose cores answer what they hear, for the tests of the loop."""

import queue
from collections.abc import Sequence
from typing import ClassVar

import msgspec

from builders import at
from wayline.core import Record
from wayline.inputs import Flush, Sentence, Tick
from wayline.messages import GpsFix, Message, Odometer, Pose
from wayline.node import Node
from wayline.service import Feed, Service
from wayline.settings import Settings
from wayline.view import Receipt

TENTH_NS = 100_000_000
ONE = Settings(vehicle_id="bus-7")
ALL = Settings(vehicles=("*",))


class Echo:
    """An odometer for each fix (1 m/s), tick (2 m/s), sentence (3 m/s) and at the end (4 m/s)."""

    reads: ClassVar[frozenset[type[Message]]] = frozenset({GpsFix})
    period_ns: ClassVar[int | None] = TENTH_NS

    def handle(self, message: msgspec.Struct, source: str) -> Sequence[Message | Record]:
        del source
        match message:
            case GpsFix():
                return [Odometer(t_ns=message.t_ns, speed_mps=1.0)]
            case Tick():
                return [Odometer(t_ns=message.t_ns, speed_mps=2.0)]
            case Sentence():
                return [Odometer(t_ns=at(0), speed_mps=3.0)]
            case Flush():
                return [Odometer(t_ns=message.t_ns, speed_mps=4.0)]
        return []


class Bug:
    """A core that fails."""

    reads: ClassVar[frozenset[type[Message]]] = frozenset({GpsFix})
    period_ns: ClassVar[int | None] = None

    def handle(self, message: msgspec.Struct, source: str) -> Sequence[Message | Record]:
        raise ZeroDivisionError(f"a bug in the core ({message}, {source})")


def echo(*feeds: Feed) -> Service:
    return Service(
        "echo", lambda _, source: Node(source or "echo", Echo()), Echo.reads, feeds=feeds
    )


class Told:
    """A view that notes what it is told, and which vehicles it is to forget."""

    reads: ClassVar[frozenset[type[Message]]] = frozenset({Pose})

    def __init__(self, told: "queue.SimpleQueue[tuple[str, str, str]]") -> None:
        self._told = told
        self.receipts: dict[str, Receipt] = {}
        self.forgotten: list[str] = []

    def put(self, vehicle_id: str, message: Message, source: str, receipt: Receipt) -> None:
        self.receipts[vehicle_id] = receipt
        self._told.put((vehicle_id, message.topic, source))

    def forget(self, vehicle_id: str) -> None:
        self.forgotten.append(vehicle_id)
