"""Pure: proposes a `[can.signals]` table from databases: by names, units and ranges."""

import json
import math
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import partial
from typing import NamedTuple

from cantools.database.can import Database
from cantools.database.can import Message as DbcMessage
from cantools.database.can.signal import Signal

from wayline.inputs import Frame
from wayline_can_ingest.j1939 import pgn_of
from wayline_can_ingest.plan import FramePlan
from wayline_cli.can_rules import JUDGEMENT, RECEIVER, RULES, Rule

YAW_RATE = "gyro.yaw_rate_degps"
"""Wayline's is positive to the right, most vehicles' to the left (ISO 8855)."""
PERCENT, NEWTON_METRES = "torque.engine_torque_pct", "torque.engine_torque_nm"
REFERENCE = "vehicle.engine_reference_torque_nm"
FIX = "gps_fix."
SWITCH_BITS = 2
"""As J1939 has them; others take one."""
MOST_NAMED = 3
"""Other signals that would fit, by name."""
REVERSE = re.compile(r"r(ev(erse)?)?", re.IGNORECASE)
"""A choice of a gear lever."""


class Range(NamedTuple):
    """Values of a signal that were seen."""

    least: float
    most: float


class Seen(NamedTuple):
    """What frames say of the signals of databases."""

    messages: frozenset[str]
    ranges: Mapping[tuple[str, str], Range]
    """By message and signal; without what is not available or said to be invalid."""


class Proposal(NamedTuple):
    """One line of the table."""

    quantity: str
    message: str
    signals: tuple[str, ...]
    scale: float = 1.0
    valid: str | None = None
    equals: int | None = None
    comment: str = ""
    is_asleep: bool = False
    """Printed behind a #: it needs something that only a person knows."""

    @property
    def line(self) -> str:
        """As TOML."""
        signal = self.signals[0] if len(self.signals) == 1 else self.signals
        parts = [f"message = {json.dumps(self.message)}", f"signal = {json.dumps(signal)}"]
        if self.scale != 1.0:
            parts.append(f"scale = {self.scale!r}")
        if self.equals is not None:
            parts.append(f"equals = {self.equals}")
        if self.valid is not None:
            parts.append(f"valid = {{ signal = {json.dumps(self.valid)}, equals = 1 }}")
        comment = f"  # {self.comment}" if self.comment else ""
        sign = "# " if self.is_asleep else ""
        return f'{sign}"{self.quantity}" = {{ {", ".join(parts)} }}{comment}'


def messages_by_name(databases: Iterable[Database]) -> dict[str, DbcMessage]:
    """Every message; of two with the same name the first, as can-ingest takes it."""
    found: dict[str, DbcMessage] = {}
    for database in databases:
        for message in database.messages:
            found.setdefault(message.name, message)
    return found


def is_matched_by_pgn(messages: Iterable[DbcMessage], frames: Iterable[Frame]) -> bool:
    """Whether more of the messages are heard by their PGN than by their very identifier."""
    heard = {each.arbitration_id for each in frames if each.extended}
    groups = {pgn_of(identifier) for identifier in heard}
    extended = [each.frame_id for each in messages if each.is_extended_frame]
    by_group = sum(pgn_of(identifier) in groups for identifier in extended)
    return by_group > sum(identifier in heard for identifier in extended)


def seen_in(messages: Iterable[DbcMessage], frames: Iterable[Frame], *, j1939: bool) -> Seen:
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
    return Seen(frozenset(each.name for each in every), ranges)


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


def propose(messages: Mapping[str, DbcMessage], seen: Seen | None) -> list[Proposal]:
    """The likeliest place of every quantity; with nothing heard, of the whole databases."""
    proposals = []
    for rule in RULES:
        ranked = _ranked(messages.values(), partial(_rank, rule, seen))
        if ranked:
            proposals.append(_proposal(rule, ranked))
    levers = _ranked(messages.values(), partial(_lever_rank, seen))
    if levers:
        proposals.append(_reverse(*levers[0]))
    return _consistent(proposals)


def _consistent(proposals: Sequence[Proposal]) -> list[Proposal]:
    """Torque in one unit; percent with what they are of; a fix with its place."""
    known = {each.quantity for each in proposals}
    unwanted = set()
    if NEWTON_METRES in known:
        unwanted.add(PERCENT)
    if PERCENT not in known - unwanted:
        unwanted.add(REFERENCE)
    if not {"gps_fix.lat_deg", "gps_fix.lon_deg"} <= known:
        unwanted |= {each for each in known if each.startswith(FIX)}
    kept = [each for each in proposals if each.quantity not in unwanted]
    if REFERENCE in known - unwanted:
        return kept
    comment = "set vehicle.engine_reference_torque_nm, then take the # away"
    return [
        each._replace(is_asleep=True, comment=comment) if each.quantity == PERCENT else each
        for each in kept
    ]


Ranks = Callable[[DbcMessage, Signal], tuple[bool, ...] | None]


def _ranked(messages: Iterable[DbcMessage], rank_of: Ranks) -> list[tuple[DbcMessage, Signal]]:
    """Candidates, the likeliest first."""
    found = []
    for message in messages:
        for signal in message.signals:
            rank = rank_of(message, signal)
            if rank is not None:
                found.append((rank, message, signal))
    found.sort(key=lambda each: each[0], reverse=True)
    return [(message, signal) for _, message, signal in found]


def _rank(
    rule: Rule, seen: Seen | None, message: DbcMessage, signal: Signal
) -> tuple[bool, ...] | None:
    """None for something else. What was seen to change goes first, then a unit, then wheels."""
    scale = _scale(rule, signal)
    if scale is None or not _is_named(rule, message, signal):
        return None
    if abs(signal.conversion.scale * scale) > rule.coarsest:
        return None
    changes = False
    if seen is not None:
        values = seen.ranges.get((message.name, signal.name))
        if values is None or not _fits(rule, values, scale):
            return None
        changes = values.most > values.least
    return changes, bool(signal.unit), "wheel" in signal.name.lower()


def _is_named(rule: Rule, message: DbcMessage, signal: Signal) -> bool:
    """Whether a signal is called as the quantity often is, and is a switch where that is one."""
    name = f"{message.name}.{signal.name}".lower()
    if not re.search(rule.names, name) or re.search(rule.never, name):
        return False
    is_receiver = bool(re.search(RECEIVER, name))
    return (
        not re.search(JUDGEMENT, signal.name.lower())
        and rule.of_receiver in (None, is_receiver)
        and (signal.length <= SWITCH_BITS) == rule.is_switch
    )


def _fits(rule: Rule, values: Range, scale: float) -> bool:
    return rule.least <= values.least * scale and values.most * scale <= rule.most


def _scale(rule: Rule, signal: Signal) -> float | None:
    """To our unit; None for a unit of something else."""
    unit = (signal.unit or "").strip().lower().replace("°", "deg").replace(" ", "")
    if not unit:
        return None if "%" in rule.units else next(iter(rule.units.values()))
    return rule.units.get(unit)


def _proposal(rule: Rule, ranked: Sequence[tuple[DbcMessage, Signal]]) -> Proposal:
    message, signal = ranked[0]
    scale = _scale(rule, signal) or 1.0
    signals = _axle(message, signal)
    notes = []
    if rule.quantity == YAW_RATE:
        scale = -scale
        notes.append("must be positive in a right turn: check, and turn the sign if not")
    if not signal.unit and "" not in rule.units:
        notes.append(f"no unit in the database, {next(iter(rule.units))} assumed")
    if re.search(r"z$", signal.name, re.IGNORECASE):
        notes.append("of a box that lies flat; else its upright axis")
    notes += _others(ranked, (message, signals))
    return Proposal(
        rule.quantity, message.name, signals, scale,
        valid=validity_of(message, signal),
        equals=1 if rule.is_switch and signal.length > 1 else None,
        comment="; ".join(notes),
    )  # fmt: skip


def _others(
    ranked: Iterable[tuple[DbcMessage, Signal]], chosen: tuple[DbcMessage, tuple[str, ...]]
) -> list[str]:
    """Other signals that would fit as well."""
    places = dict.fromkeys((message.name, _axle(message, signal)) for message, signal in ranked)
    del places[chosen[0].name, chosen[1]]
    names = [f"{message}.{'/'.join(signals)}" for message, signals in places]
    return [f"or {', '.join(names[:MOST_NAMED])}"] if names else []


def _axle(message: DbcMessage, signal: Signal) -> tuple[str, ...]:
    """Both wheels of the rear axle where a signal is one of four wheels."""
    names = {each.name for each in message.signals}
    upper = signal.name.upper()
    if upper.endswith(("FL", "FR", "RL", "RR")):
        pair = tuple(signal.name[:-2] + side for side in ("RL", "RR"))
        if names.issuperset(pair):
            return pair
    return (signal.name,)


def _lever_rank(seen: Seen | None, message: DbcMessage, signal: Signal) -> tuple[bool, ...] | None:
    """A gear lever that can stand in reverse."""
    if "gear" not in signal.name.lower() or _reverse_choice(signal) is None:
        return None
    if seen is None:
        return (True,)
    values = seen.ranges.get((message.name, signal.name))
    return None if values is None else (values.most > values.least,)


def _reverse_choice(signal: Signal) -> int | None:
    choices = dict(signal.choices or {})
    return next(
        (raw for raw, word in choices.items() if REVERSE.fullmatch(str(word).strip())), None
    )


def _reverse(message: DbcMessage, signal: Signal) -> Proposal:
    return Proposal(
        "odometer.reverse", message.name, (signal.name,), equals=_reverse_choice(signal)
    )
