"""Pure: compiles `[can.signals]` and its databases into one plan a frame identifier."""

import difflib
from collections.abc import Iterable, Sequence

from cantools.database.can import Database
from cantools.database.can import Message as DbcMessage
from cantools.database.can.signal import Signal
from cantools.database.errors import DecodeError

from wayline.drive import CanMapping, Vehicle
from wayline.errors import InputError
from wayline.inputs import Frame
from wayline_can_ingest.quantity import (
    QUANTITIES,
    Extractor,
    Signals,
    needed_signals,
    not_available,
)

FrameKey = tuple[int, bool]
"""Identifier and whether it is extended; with J1939 the PGN and True."""


class FramePlan:
    """How one frame is decoded and which quantities come of it, grouped by topic."""

    def __init__(self, message: DbcMessage, j1939: bool) -> None:
        self.name = message.name
        self.extractors: list[Extractor] = []
        self.kept: set[str] = set()
        """Signals whose newest value conditions in other frames ask for."""
        self._message = message
        self._signals = message.signals
        self._raw_signals = {signal.name: signal for signal in message.signals} if j1939 else {}

    def decode(self, frame: Frame) -> Signals:
        """Decoded signals that the frame holds; empty for an unlisted multiplexer value."""
        try:
            values = self._message.decode_simple(
                frame.data,
                decode_choices=False,
                scaling=not self._raw_signals,
                allow_truncated=True,
            )
        except DecodeError:
            return {}
        if not self._raw_signals:
            return values  # type: ignore[return-value]
        return dict(self._available(values))  # type: ignore[arg-type]

    def narrow(self, needed: set[str]) -> None:
        """Leave out signals that nobody asks for; a multiplexed frame is decoded whole."""
        message = self._message
        if message.is_multiplexed():
            return
        self._message = DbcMessage(
            message.frame_id,
            message.name,
            message.length,
            [signal for signal in message.signals if signal.name in needed],
            is_extended_frame=message.is_extended_frame,
            strict=False,
        )

    def counter_span_m(self, field: str) -> float:
        """Distance at which the counter mapped to a field begins again at 0."""
        extractor = next(each for each in self.extractors if each.field == field)
        signal = next(each for each in self._signals if each.name == extractor.signals[0])
        return float(2**signal.length * abs(signal.conversion.scale * extractor.scale))

    def _available(self, values: dict[str, float]) -> Iterable[tuple[str, float | None]]:
        for name, raw in values.items():
            signal = self._raw_signals[name]
            known = signal.conversion.is_float or not not_available(raw, signal.length)
            yield name, signal.conversion.raw_to_scaled(raw, False) if known else None  # type: ignore[misc]


class Mapping:
    """The plans of one `[[can]]` source, looked up by frame."""

    def __init__(self, plans: dict[FrameKey, FramePlan], j1939: bool) -> None:
        self.plans = plans
        self.j1939 = j1939
        self.gps_fields = frozenset(
            (plan.name, extractor.field)
            for plan in plans.values()
            for extractor in plan.extractors
            if extractor.topic == "gps_fix"
        )

    def find(self, frame: Frame) -> FramePlan | None:
        """The plan for a frame, None for one that is not mapped."""
        if self.j1939:
            if not frame.extended:
                return None
            return self.plans.get((pgn_of(frame.arbitration_id), True))
        return self.plans.get((frame.arbitration_id, frame.extended))


def pgn_of(identifier: int) -> int:
    """Parameter group number of a 29-bit identifier, without priority, source, destination."""
    pgn = (identifier >> 8) & 0x3FFFF
    peer_to_peer = (pgn >> 8) & 0xFF < 0xF0
    return pgn & 0x3FF00 if peer_to_peer else pgn


def compile_mapping(
    source: CanMapping, databases: Sequence[Database], vehicle: Vehicle, where: str
) -> Mapping:
    """Check every mapping against its database; InputError names the key and the mend.

    `where` names the file that holds the mapping.
    """
    directory = _Directory(databases, where)
    plans: dict[FrameKey, FramePlan] = {}
    needed: dict[FrameKey, set[str]] = {}

    def plan_for(message_name: str, quantity: str) -> tuple[FrameKey, FramePlan]:
        message = directory.message(message_name, quantity)
        key = _key(message, source.j1939)
        return key, plans.setdefault(key, FramePlan(message, source.j1939))

    for quantity, mapping in source.signals.items():
        _check_quantity(quantity, where)
        message = directory.message(mapping.message, quantity)
        key, plan = plan_for(mapping.message, quantity)
        extractor = Extractor(quantity, mapping, message)
        for signal in needed_signals(extractor, mapping):
            directory.signal(message, signal, quantity)
        plan.extractors.append(extractor)
        needed.setdefault(key, set()).update(needed_signals(extractor, mapping))
        for other, signal in extractor.conditions_elsewhere():
            directory.signal(directory.message(other, quantity), signal, quantity)
            other_key, other_plan = plan_for(other, quantity)
            other_plan.kept.add(signal)
            needed.setdefault(other_key, set()).add(signal)
    if clock := source.clock:
        directory.signal(directory.message(clock.message, "clock"), clock.signal, "clock")
        key, plan = plan_for(clock.message, "clock")
        plan.kept.add(clock.signal)
        needed.setdefault(key, set()).add(clock.signal)
    for key, plan in plans.items():
        plan.narrow(needed[key])
    _check_torque(source, vehicle, where)
    return Mapping(plans, source.j1939)


class _Directory:
    """Finds messages and signals over several databases, or says what there is instead."""

    def __init__(self, databases: Sequence[Database], where: str) -> None:
        self._where = where
        self._messages = {m.name: m for database in databases for m in database.messages}

    def message(self, name: str, quantity: str) -> DbcMessage:
        if name in self._messages:
            return self._messages[name]
        raise InputError(
            self._where,
            f'"{quantity}" names message {name}, which no dbc of this [[can]] has',
            _did_you_mean(name, self._messages),
        )

    def signal(self, message: DbcMessage, name: str, quantity: str) -> Signal:
        signals = {signal.name: signal for signal in message.signals}
        if name in signals:
            return signals[name]
        raise InputError(
            self._where,
            f'"{quantity}" names signal {name}, which message {message.name} does not have',
            _did_you_mean(name, signals),
        )


def _did_you_mean(name: str, known: Iterable[str]) -> str:
    names = sorted(known)
    near = difflib.get_close_matches(name, names, n=3, cutoff=0.5) or names[:8]
    return f"did you mean {', '.join(near)}?" if near else "name a dbc that has it"


def _key(message: DbcMessage, j1939: bool) -> FrameKey:
    if j1939:
        return pgn_of(message.frame_id), True
    return message.frame_id, message.is_extended_frame


def _check_quantity(quantity: str, where: str) -> None:
    if quantity not in QUANTITIES:
        mend = _did_you_mean(quantity, QUANTITIES)
        raise InputError(where, f'[can.signals] cannot map "{quantity}"', mend)


def _check_torque(source: CanMapping, vehicle: Vehicle, where: str) -> None:
    known = vehicle.engine_reference_torque_nm is not None
    mapped = "vehicle.engine_reference_torque_nm" in source.signals
    if "torque.engine_torque_pct" in source.signals and not (known or mapped):
        raise InputError(
            where,
            '"torque.engine_torque_pct" has no reference torque',
            "set vehicle.engine_reference_torque_nm or map it",
        )
