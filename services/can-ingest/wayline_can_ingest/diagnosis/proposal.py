"""Pure: proposes a `[can.signals]` table from databases: by names, units and ranges."""

import json
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import partial
from typing import NamedTuple

from cantools.database.can import Database
from cantools.database.can import Message as DbcMessage
from cantools.database.can.signal import Signal

from wayline_can_ingest.diagnosis.rules import JUDGEMENT, RECEIVER, RULES, Rule
from wayline_can_ingest.diagnosis.seen import Range, SignalsSeen, validity_of

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


def propose(messages: Mapping[str, DbcMessage], seen: SignalsSeen | None) -> list[Proposal]:
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
    rule: Rule, seen: SignalsSeen | None, message: DbcMessage, signal: Signal
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


def _lever_rank(
    seen: SignalsSeen | None, message: DbcMessage, signal: Signal
) -> tuple[bool, ...] | None:
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
