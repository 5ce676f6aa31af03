"""Pure: compiles `[can.signals]`, profiles and their databases into plans, looked up by frame."""

from collections.abc import Iterator, Sequence
from functools import lru_cache
from typing import NamedTuple

from cantools.database.can import Database
from cantools.database.can import Message as DbcMessage

from wayline.drive import CanMapping, Places, SignalMapping, Vehicle
from wayline.errors import InputError
from wayline_can_ingest.directory import Directory, Part, did_you_mean
from wayline_can_ingest.j1939 import pgn_of
from wayline_can_ingest.plan import FramePlan
from wayline_can_ingest.quantity import CLOCK, QUANTITIES, Extractor

IDENTIFIERS_KEPT = 4096
"""Identifiers whose plans are remembered; a bus has some hundred."""
SAME = {"torque.engine_torque_pct": "torque.engine_torque_nm"}
"""Two ways to one field: who maps one of them wants no profile's other."""

FIX = "gps_fix."


class FrameKey(NamedTuple):
    """What tells a frame: its identifier, or its parameter group number (J1939)."""

    number: int
    extended: bool
    is_pgn: bool = False


class Mapping:
    """The plans of one `[[can]]` source."""

    def __init__(self, plans: dict[FrameKey, tuple[FramePlan, ...]]) -> None:
        self.plans = plans
        self.pgns = frozenset(key.number for key in plans if key.is_pgn)
        self.gps_fields = frozenset(
            (plan.name, extractor.field)
            for each in plans.values()
            for plan in each
            for extractor in plan.extractors
            if extractor.topic == "gps_fix"
        )
        self.find = lru_cache(IDENTIFIERS_KEPT)(self._find)
        """Plans for an identifier that may be extended; empty where it is not mapped."""

    def _find(self, identifier: int, extended: bool) -> tuple[FramePlan, ...]:
        plans = self.plans.get(FrameKey(identifier, extended), ())
        if not extended:
            return plans
        return plans + self.plans.get(FrameKey(pgn_of(identifier), True, True), ())


def compile_mapping(
    source: CanMapping,
    databases: Sequence[Database],
    vehicle: Vehicle,
    where: str,
    profiles: Sequence[Part] = (),
) -> Mapping:
    """Check every mapping against its database; InputError names the key and the mend.

    `where` names the file that holds the mapping. The source's own signals may name messages of
    the profiles too, and go over the profiles' signals.
    """
    parts = [Part(where, source.signals, source.j1939, databases), *profiles]
    plans = _Plans()
    for part in parts:
        for quantity in part.signals:
            _check_quantity(quantity, part.where)
    mapped = list(_chosen(parts))
    for position, quantity, places in mapped:
        directory = Directory(parts if position == 0 else [parts[position]])
        for rank, place in enumerate(places):
            plans.add(directory, quantity, place, rank if len(places) > 1 else None)
    if clock := source.clock:
        place = SignalMapping(message=clock.message, signal=clock.signal, valid=clock.valid)
        plans.add(Directory(parts), CLOCK, place, None)
    _check_torque({quantity for _, quantity, _ in mapped}, vehicle, where)
    return plans.mapping()


def _chosen(parts: Sequence[Part]) -> Iterator[tuple[int, str, tuple[SignalMapping, ...]]]:
    """Every quantity once, with the part that maps it first.

    A fix is one receiver's: of the profiles only the first that has one gives its fields.
    """
    taken: set[str] = set()
    for position, part in enumerate(parts):
        fresh = [each for each in part.signals if not taken & _names(each)]
        for quantity in fresh:
            yield position, quantity, _places(part.signals[quantity])
        taken |= {SAME.get(each, each) for each in fresh}
        if position > 0 and any(each.startswith(FIX) for each in fresh):
            taken.add(FIX)


def _names(quantity: str) -> set[str]:
    """What stands for a quantity among those taken."""
    return {SAME.get(quantity, quantity)} | ({FIX} if quantity.startswith(FIX) else set())


def _places(places: Places) -> tuple[SignalMapping, ...]:
    return (places,) if isinstance(places, SignalMapping) else places


class _Plans:
    """Plans as they grow, one for each message of a database that is asked for."""

    def __init__(self) -> None:
        self._plans: dict[tuple[FrameKey, DbcMessage], FramePlan] = {}

    def add(
        self, directory: Directory, quantity: str, mapping: SignalMapping, rank: int | None
    ) -> None:
        """Plan for a place of a quantity, and for what its conditions ask for."""
        message, j1939 = directory.message(mapping.message, quantity)
        for signal in mapping.signals:
            directory.check_signal(message, signal, quantity)
        extractor = Extractor(quantity, mapping, message, rank=rank, j1939=j1939)
        for signal in extractor.own_signals():
            directory.check_signal(message, signal, quantity)
        self._plan(message, j1939).extractors.append(extractor)
        for other, signal in extractor.conditions_elsewhere():
            known = directory.message(other, quantity)
            directory.check_signal(known.message, signal, quantity)
            self._plan(known.message, known.j1939).kept.add(signal)

    def _plan(self, message: DbcMessage, j1939: bool) -> FramePlan:
        key = _key(message, j1939)
        return self._plans.setdefault((key, message), FramePlan(message, j1939=j1939))

    def mapping(self) -> Mapping:
        """The plans of all frames asked for, compiled."""
        plans: dict[FrameKey, tuple[FramePlan, ...]] = {}
        for (key, _), plan in self._plans.items():
            plan.compile()
            plans[key] = (*plans.get(key, ()), plan)
        return Mapping(plans)


def _key(message: DbcMessage, j1939: bool) -> FrameKey:
    if j1939:
        return FrameKey(pgn_of(message.frame_id), True, True)
    return FrameKey(message.frame_id, message.is_extended_frame)


def _check_quantity(quantity: str, where: str) -> None:
    if quantity not in QUANTITIES:
        mend = did_you_mean(quantity, QUANTITIES)
        raise InputError(where, f'[can.signals] cannot map "{quantity}"', mend)


def _check_torque(mapped: set[str], vehicle: Vehicle, where: str) -> None:
    known = vehicle.engine_reference_torque_nm is not None
    if "torque.engine_torque_pct" in mapped and not (
        known or "vehicle.engine_reference_torque_nm" in mapped
    ):
        raise InputError(
            where,
            '"torque.engine_torque_pct" has no reference torque',
            "set vehicle.engine_reference_torque_nm or map it",
        )
