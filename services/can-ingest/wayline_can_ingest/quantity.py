"""Pure: from the decoded signals of one frame to one quantity, as `[can.signals]` says."""

import math
from collections.abc import Callable, Mapping
from typing import Any, Literal, get_args, get_origin

import msgspec
from cantools.database.can import Message as DbcMessage

from wayline.drive import Condition, SignalMapping
from wayline.messages import TOPICS, field_types

Signals = Mapping[str, float | None]
"""Decoded values by signal name; None is "not available", a signal not in the frame is missing."""
Latest = Mapping[tuple[str, str], float | None]
"""Newest value of signals that conditions in other frames ask for, by (message, signal)."""
Value = float | int | bool | str

INGESTED_TOPICS = ("odometer", "gyro", "torque", "barometer", "gps_fix")
DERIVED = {"torque.engine_torque_pct", "vehicle.engine_reference_torque_nm"}
QUANTITIES = DERIVED | {
    f"{topic}.{field}"
    for topic in INGESTED_TOPICS
    for field in field_types(TOPICS[topic])
    if field not in ("t_ns", "repeat")
}
"""Every name that `[can.signals]` may map."""

J1939_ERROR_TOP = 0xFE
"""SAE J1939-71: a top byte of FEh is "error", FFh "not available"."""


class Extractor:
    """Reads one quantity from a frame: mean of signals, scale, words, truth, validity, bounds."""

    def __init__(self, quantity: str, mapping: SignalMapping, message: DbcMessage) -> None:
        self.quantity = quantity
        self.topic, _, self.field = quantity.partition(".")
        self.message = message.name
        signal = mapping.signal
        self.signals: tuple[str, ...] = (signal,) if isinstance(signal, str) else signal
        self.scale = mapping.scale
        self.latency_ns = round(mapping.latency_s * 1e9)
        valid = mapping.valid
        self._conditions = (valid,) if isinstance(valid, Condition) else valid
        self._convert = _converter(quantity, mapping)

    def conditions_elsewhere(self) -> set[tuple[str, str]]:
        """Signals of other frames that decide on this quantity."""
        return {
            (condition.message, condition.signal)
            for condition in self._conditions
            if condition.message not in (None, self.message)
        }

    def read(self, signals: Signals, latest: Latest) -> Value | None:
        """The quantity in our unit; None where absent, invalid or out of its bounds."""
        total = 0.0
        for name in self.signals:
            value = signals.get(name)
            if value is None:
                return None
            total += value
        for condition in self._conditions:
            if not self._holds(condition, signals, latest):
                return None
        return self._convert(total / len(self.signals))

    def _holds(self, condition: Condition, signals: Signals, latest: Latest) -> bool:
        if condition.message in (None, self.message):
            value = signals.get(condition.signal)
        else:
            value = latest.get((str(condition.message), condition.signal))
        if value is None:
            return False
        return (
            (condition.equals is None or value == condition.equals)
            and (condition.min is None or value >= condition.min)
            and (condition.max is None or value <= condition.max)
        )


def needed_signals(extractor: Extractor, mapping: SignalMapping) -> set[str]:
    """Signals of the extractor's own frame that it reads."""
    valid = (mapping.valid,) if isinstance(mapping.valid, Condition) else mapping.valid
    own = {c.signal for c in valid if c.message in (None, extractor.message)}
    return own | set(extractor.signals)


def not_available(raw: float, length_bits: int) -> bool:
    """Whether a raw J1939 value means "not available" or "error" (SAE J1939-71 5.1.4)."""
    value = int(raw)
    if length_bits >= 8:
        return (value >> (length_bits - 8)) >= J1939_ERROR_TOP
    if length_bits >= 2:
        return value >= (1 << length_bits) - 2
    return False


def _converter(quantity: str, mapping: SignalMapping) -> Callable[[float], Value | None]:
    if quantity in DERIVED:
        return _number(mapping, None)
    topic, _, field = quantity.partition(".")
    annotation = field_types(TOPICS[topic])[field]
    kinds = _kinds(annotation)
    if bool in kinds:
        wanted = mapping.equals
        return lambda raw: raw != 0 if wanted is None else raw == wanted
    if mapping.values or str in kinds:
        return _word(mapping, annotation)
    if int in kinds and float not in kinds:
        return _whole(mapping, annotation)
    signed_speed = quantity == "odometer.speed_mps"
    return _number(mapping, None if signed_speed else annotation)


def _number(mapping: SignalMapping, annotation: object) -> Callable[[float], float | None]:
    scale, offset = mapping.scale, mapping.offset
    low, high, open_low, open_high = _bounds(annotation)

    def convert(raw: float) -> float | None:
        value = raw * scale + offset
        if not low <= value <= high or value in (open_low, open_high):
            return None
        return value

    return convert


def _whole(mapping: SignalMapping, annotation: object) -> Callable[[float], int | None]:
    number = _number(mapping, annotation)

    def convert(raw: float) -> int | None:
        value = number(raw)
        return None if value is None else round(value)

    return convert


def _word(mapping: SignalMapping, annotation: object) -> Callable[[float], Value | None]:
    def convert(raw: float) -> Value | None:
        word = mapping.values.get(str(int(raw)))
        if word is None:
            return None
        try:
            return msgspec.convert(word, annotation, strict=False)  # type: ignore[no-any-return]
        except msgspec.ValidationError:
            return None

    return convert


def _bounds(annotation: object) -> tuple[float, float, float | None, float | None]:
    """Closed bounds of an annotated number, and the values that an open bound excludes."""
    low, high = -math.inf, math.inf
    open_low: float | None = None
    open_high: float | None = None
    for meta in _metas(annotation):
        low = next((b for b in (meta.ge, meta.gt) if b is not None), low)
        high = next((b for b in (meta.le, meta.lt) if b is not None), high)
        open_low = meta.gt if meta.gt is not None else open_low
        open_high = meta.lt if meta.lt is not None else open_high
    return low, high, open_low, open_high


def _metas(annotation: Any) -> list[msgspec.Meta]:
    own = [
        meta for meta in getattr(annotation, "__metadata__", ()) if isinstance(meta, msgspec.Meta)
    ]
    return own + [meta for part in get_args(annotation) for meta in _metas(part)]


def _kinds(annotation: Any) -> set[type]:
    """The plain types that an annotation admits (words count as str, numbers as their type)."""
    if annotation in (bool, int, float, str):
        return {annotation}
    if get_origin(annotation) is Literal:
        return {type(value) for value in get_args(annotation)}
    return {kind for part in get_args(annotation) for kind in _kinds(part)}
