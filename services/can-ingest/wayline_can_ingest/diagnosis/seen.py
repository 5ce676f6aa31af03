"""Pure: what frames say of the signals of a database: which come, between which values."""

import math
import re
from collections.abc import Iterable, Mapping
from typing import NamedTuple

from cantools.database.can import Message as DbcMessage
from cantools.database.can.signal import Signal

from wayline.inputs import Frame
from wayline_can_ingest.j1939 import pgn_of
from wayline_can_ingest.plan import FramePlan


class Range(NamedTuple):
    """Values of a signal that were seen."""

    least: float
    most: float


class SignalsSeen(NamedTuple):
    """What frames say of the signals of databases."""

    messages: frozenset[str]
    ranges: Mapping[tuple[str, str], Range]
    """By message and signal; without what is not available or said to be invalid."""


def is_matched_by_pgn(messages: Iterable[DbcMessage], frames: Iterable[Frame]) -> bool:
    """Whether more of the messages are heard by their PGN than by their very identifier."""
    heard = {each.arbitration_id for each in frames if each.extended}
    groups = {pgn_of(identifier) for identifier in heard}
    extended = [each.frame_id for each in messages if each.is_extended_frame]
    by_group = sum(pgn_of(identifier) in groups for identifier in extended)
    return by_group > sum(identifier in heard for identifier in extended)


def seen_in(messages: Iterable[DbcMessage], frames: Iterable[Frame], *, j1939: bool) -> SignalsSeen:
    """The range of every signal that frames hold. By PGN only 29-bit messages are known."""
    plans: dict[tuple[int, bool], list[_Watched]] = {}
    for message in messages:
        if message.signals and (message.is_extended_frame or not j1939):
            key = _key(message.frame_id, message.is_extended_frame, j1939)
            plans.setdefault(key, []).append(_Watched(message, j1939=j1939))
    for frame in frames:
        for watched in plans.get(_key(frame.arbitration_id, frame.extended, j1939), ()):
            watched.take(frame.data)
    every = [each for found in plans.values() for each in found if each.is_seen]
    ranges = {
        (each.name, signal): Range(*limits)
        for each in every
        for signal, limits in each.limits.items()
    }
    return SignalsSeen(frozenset(each.name for each in every), ranges)


def _key(identifier: int, extended: bool, j1939: bool) -> tuple[int, bool]:
    return (pgn_of(identifier), True) if j1939 and extended else (identifier, extended)


class _Watched:
    """A message, and between which values its signals were."""

    def __init__(self, message: DbcMessage, *, j1939: bool) -> None:
        self.name = message.name
        self.is_seen = False
        self.limits: dict[str, list[float]] = {}
        self._validity = {each.name: validity_of(message, each) for each in message.signals}
        plan = FramePlan(message, j1939=j1939)
        plan.kept.update(self._validity)
        plan.compile()
        self._decode = plan.decode

    def take(self, data: bytes) -> None:
        """Widen the limits."""
        values = self._decode(data)
        self.is_seen = True
        for name, value in values.items():
            if value is None or not math.isfinite(value):
                continue
            judge = self._validity[name]
            if judge is not None and values.get(judge) != 1:
                continue
            limits = self.limits.setdefault(name, [value, value])
            if value < limits[0]:
                limits[0] = value
            elif value > limits[1]:
                limits[1] = value


def validity_of(message: DbcMessage, signal: Signal) -> str | None:
    """The bit of a message that says whether a signal is valid; None without one."""
    bits = [
        each.name
        for each in message.signals
        if each.length == 1 and re.search(r"(?<!in)valid", each.name, re.IGNORECASE)
    ]
    if signal.name in bits:
        return None
    if len(bits) == 1:
        return bits[0]
    return next((bit for bit in bits if _stem(bit) and _stem(bit) in signal.name.lower()), None)


def _stem(bit: str) -> str:
    return bit.lower().replace("valid", "").strip("_")
