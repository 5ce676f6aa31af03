"""Pure: from the decoded signals of one frame to one quantity, as `[can.signals]` says."""

import math
from collections.abc import Callable, Mapping
from typing import Any, Literal, get_args, get_origin

import msgspec
from cantools.database.can import Message as DbcMessage

from wayline.drive import Condition, SignalMapping
from wayline.messages import TOPICS, BearingDeg, SignedSpeed, field_types
from wayline_can_ingest.j1939 import counter_turns

Signals = Mapping[str, float | None]
"""Decoded values by signal name; None is "not available", a signal not in the frame is missing."""
Latest = Mapping[tuple[str, str], float | None]
"""Newest value of signals that conditions in other frames ask for, by (message, signal)."""
Value = float | int | bool | str

INGESTED_TOPICS = ("odometer", "gyro", "torque", "barometer", "gps_fix")
CLOCK = "clock.utc_s"
"""What `clock = { message, signal }` maps."""
DERIVED = {
    "torque.engine_torque_pct",
    "vehicle.engine_friction_pct",
    "vehicle.engine_reference_torque_nm",
}
COUNTED_OR_SIGNED = {"odometer.distance_m", "odometer.speed_mps"}
QUANTITIES = DERIVED | {
    f"{topic}.{field}"
    for topic in INGESTED_TOPICS
    for field in field_types(TOPICS[topic])
    if field not in ("t_ns", "repeat")
}
"""Every name that `[can.signals]` may map."""


class Extractor:
    """Reads one quantity from a frame: mean of signals, scale, words, truth, validity, bounds."""

    def __init__(
        self,
        quantity: str,
        mapping: SignalMapping,
        message: DbcMessage,
        *,
        rank: int | None = None,
        j1939: bool = False,
    ) -> None:
        self.quantity = quantity
        self.topic, _, self.field = quantity.partition(".")
        self.message = message.name
        self.rank = rank
        """Place in the list where a quantity has several; None where it has one."""
        self.signals = mapping.signals
        self._only = self.signals[0] if len(self.signals) == 1 else None
        self.is_derived = quantity in DERIVED or quantity in COUNTED_OR_SIGNED
        """Whether its field is not just what is read."""
        self.latency_ns = round(mapping.latency_s * 1e9)
        self._conditions = mapping.conditions
        self._convert = _converter(quantity, mapping, message)
        self._mapping, self._message, self._j1939 = mapping, message, j1939

    @property
    def span(self) -> float:
        """Value at which the counter that is mapped begins again at 0."""
        signal = self._message.get_signal_by_name(self.signals[0])
        turns = counter_turns(signal.length) if self._j1939 else 2**signal.length
        return float(turns * abs(signal.conversion.scale * self._mapping.scale))

    def own_signals(self) -> set[str]:
        """Signals of its own frame that it reads."""
        own = {c.signal for c in self._conditions if c.message in (None, self.message)}
        return own | set(self.signals)

    def conditions_elsewhere(self) -> set[tuple[str, str]]:
        """Signals of other frames that decide on this quantity."""
        return {
            (condition.message, condition.signal)
            for condition in self._conditions
            if condition.message not in (None, self.message)
        }

    def is_held_by(self, signals: Signals) -> bool:
        """Whether a frame holds what is read, though it may say that there is no value."""
        return all(name in signals for name in self.signals)

    def read(self, signals: Signals, latest: Latest) -> Value | None:
        """The quantity in our unit; None where absent, invalid or out of its bounds."""
        value = signals.get(self._only) if self._only is not None else self._mean(signals)
        if value is None or not math.isfinite(value):
            return None
        for condition in self._conditions:
            if not self._holds(condition, signals, latest):
                return None
        return self._convert(value)

    def _mean(self, signals: Signals) -> float | None:
        total = 0.0
        for name in self.signals:
            value = signals.get(name)
            if value is None:
                return None
            total += value
        return total / len(self.signals)

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


def _converter(
    quantity: str, mapping: SignalMapping, message: DbcMessage
) -> Callable[[float], Value | None]:
    if quantity in DERIVED or quantity == CLOCK:
        return _number(mapping, None)
    topic, _, field = quantity.partition(".")
    annotation = field_types(TOPICS[topic])[field]
    kinds = _kinds(annotation)
    if bool in kinds:
        wanted = mapping.equals
        return lambda raw: raw != 0 if wanted is None else raw == wanted
    if mapping.values or str in kinds:
        return _word(mapping, message, annotation)
    if int in kinds and float not in kinds:
        return _whole(mapping, annotation)
    if annotation == BearingDeg | None:
        return _bearing(mapping)
    # wheels that turn backwards are told by the sign, until it is taken for `reverse`
    return _number(mapping, SignedSpeed if quantity == "odometer.speed_mps" else annotation)


def _number(mapping: SignalMapping, annotation: object) -> Callable[[float], float | None]:
    scale, offset = mapping.scale, mapping.offset
    low, high, open_low, open_high = _bounds(annotation)

    def convert(value: float) -> float | None:
        value = value * scale + offset
        if not low <= value <= high or value in (open_low, open_high):
            return None
        return value

    return convert


def _bearing(mapping: SignalMapping) -> Callable[[float], float | None]:
    """Buses count bearings from 0 to 360, both included, or from -180 to 180."""
    scale, offset = mapping.scale, mapping.offset

    def convert(value: float) -> float | None:
        value = value * scale + offset
        return value % 360.0 if -360.0 < value <= 360.0 else None

    return convert


def _whole(mapping: SignalMapping, annotation: object) -> Callable[[float], Value | None]:
    number = _number(mapping, None)

    def convert(value: float) -> Value | None:
        scaled = number(value)
        return None if scaled is None else _fitting(round(scaled), annotation)

    return convert


def _word(
    mapping: SignalMapping, message: DbcMessage, annotation: object
) -> Callable[[float], Value | None]:
    """Words are given for raw values: those before the database's scale and offset."""
    raw_of = message.get_signal_by_name(mapping.signals[0]).conversion.numeric_scaled_to_raw

    def convert(value: float) -> Value | None:
        word = mapping.values.get(str(round(raw_of(value))))
        return None if word is None else _fitting(word, annotation)

    return convert


def _fitting(value: Value, annotation: object) -> Value | None:
    """A value that its field may have, else None."""
    try:
        return msgspec.convert(value, annotation, strict=False)  # type: ignore[no-any-return]
    except msgspec.ValidationError:
        return None


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
