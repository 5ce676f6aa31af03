"""What a vehicle's services say while it drives along a parallel, stands and drives again."""

import math
from collections.abc import Iterable, Iterator
from typing import Any

import msgspec

from builders import at
from wayline.core import Record
from wayline.inputs import Flush
from wayline.messages import Message, Pose, Trip
from wayline.node import Node
from wayline_history.core import HistoryCore
from wayline_history.layouts import Kind
from wayline_history.records import Event, Piece

VEHICLE = "bus-7"
LAT_DEG, LON_DEG = 48.1, 11.5
METRES_PER_DEGREE = 111_320.0 * math.cos(math.radians(LAT_DEG))


def pose(seconds: float, east_m: float, speed_mps: float, **fields: Any) -> Pose:
    """A pose so far east of where it began, that is known to a metre."""
    known: dict[str, Any] = {
        "mode": "fused",
        "lat_deg": LAT_DEG,
        "lon_deg": LON_DEG + east_m / METRES_PER_DEGREE,
        "alt_m": 500.0,
        "alt_std_m": 2.0,
        "heading_deg": 90.0,
        "distance_m": max(east_m, 0.0),
        "east_std_m": 1.0,
        "north_std_m": 1.0,
        "speed_std_mps": 0.1,
        **fields,
    }
    return Pose(t_ns=at(seconds), speed_mps=speed_mps, **known)


def legs(*legs: tuple[float, float], start_s: float = 0.0) -> Iterator[Pose]:
    """A pose a second: for each leg so many seconds at so many metres per second."""
    second, east_m = start_s, 0.0
    for lasts_s, speed_mps in legs:
        for _ in range(round(lasts_s)):
            yield pose(second, east_m, speed_mps)
            second += 1.0
            east_m += speed_mps


class Kept:
    """A store that remembers what it was given."""

    def __init__(self) -> None:
        self.pieces: list[Piece] = []

    def save(self, record: Record) -> tuple[msgspec.Struct, ...]:
        assert isinstance(record, Piece)
        self.pieces.append(record)
        return ()

    def rows(self, kind: Kind) -> list[tuple[int, ...]]:
        return [row for piece in self.pieces if kind in piece.rows for row in piece.rows[kind].rows]

    def events(self, kind: str) -> list[Event]:
        """Those of a kind, as they were told last."""
        last = {
            (event.t_ns, event.name): event
            for piece in self.pieces
            for event in piece.events
            if event.kind == kind
        }
        return [last[key] for key in sorted(last)]

    @property
    def trips(self) -> list[Trip]:
        return [trip for piece in self.pieces for trip in piece.trips]


def kept_of(messages: Iterable[Message], *, finish: bool = True, **options: Any) -> Kept:
    """What the core gives its store while it hears messages."""
    kept = Kept()
    core = HistoryCore(VEHICLE, **options)
    node = Node("history", core, kept)
    last_ns = 0
    for message in messages:
        list(node.take(message, "test"))
        last_ns = max(last_ns, message.t_ns)
    if finish:
        list(node.give(Flush(last_ns), "history"))
    return kept
