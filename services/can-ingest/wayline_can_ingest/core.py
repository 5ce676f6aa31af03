"""Pure: CAN frames in, odometer, gyro, torque, barometer and gps_fix messages out."""

from collections.abc import Sequence
from typing import ClassVar

import msgspec

from wayline.clock import SteadyClock
from wayline.drive import CanMapping, Vehicle
from wayline.inputs import Flush, Frame, Tick
from wayline.messages import EARLIEST_NS, LATEST_NS, Message
from wayline_can_ingest.derived import Derived, Fields
from wayline_can_ingest.fix import SpreadFix
from wayline_can_ingest.mapping import Mapping
from wayline_can_ingest.plan import FramePlan
from wayline_can_ingest.preference import Preference
from wayline_can_ingest.quantity import Extractor, Signals, Value
from wayline_can_ingest.transport import Reassembler
from wayline_can_ingest.utc import DriveClock, clock_value_s

MOST_WAITING = 100_000
"""Frames held until the clock signal has said what time it is."""


class CanIngestCore:
    """Translates the frames of one `[[can]]` source of one vehicle.

    Every `t_ns` has the clock's offset added and the mapping's and receiver's latency taken off.
    Frames that nothing maps cost one look-up. Buses of one logger share their `clock`.
    """

    reads: ClassVar[frozenset[type[Message]]] = frozenset()
    period_ns: ClassVar[int | None] = None

    def __init__(
        self,
        source: CanMapping,
        mapping: Mapping,
        vehicle: Vehicle,
        *,
        clock: DriveClock | None = None,
    ) -> None:
        self._mapping = mapping
        self._transport = Reassembler(mapping.pgns) if mapping.pgns else None
        self._derived = Derived(vehicle)
        self._preference = Preference()
        self._latest: dict[tuple[str, str], float | None] = {}
        self._clock = DriveClock.of(source) if clock is None else clock
        self._steady = SteadyClock()
        self._waiting: list[Frame] = []
        self._fix = SpreadFix(mapping.gps_fields, round(vehicle.gps_latency_s * 1e9))
        self._has_fix = bool(mapping.gps_fields)
        self._out_of_bounds = 0
        self.dropped = 0
        """Frames that came before the clock signal and did not fit the waiting room."""

    @property
    def has_no_time(self) -> bool:
        """Whether the clock signal has yet to say what time it is."""
        return self._clock.offset_ns is None

    @property
    def bad_input(self) -> int:
        """How often the clock stepped back, long messages that broke off, impossible times."""
        broken = 0 if self._transport is None else self._transport.broken
        return self._steady.steps + broken + self._out_of_bounds

    def received_ns(self, frame: Frame) -> int:
        """When a frame arrived, on the clock that the messages carry."""
        return frame.t_ns + (self._clock.offset_ns or 0)

    def handle(self, message: msgspec.Struct, source: str) -> Sequence[Message]:
        """Take a Frame, Tick or Flush; return the bus messages that it completes."""
        del source
        if isinstance(message, Frame):
            return self._frame(message)
        if isinstance(message, Flush):
            return self._flush(message.t_ns)
        if isinstance(message, Tick):
            return self._fix.overdue(message.t_ns)
        return ()

    def _flush(self, t_ns: int) -> Sequence[Message]:
        messages: list[Message] = []
        if self.has_no_time and self._clock.settle():
            self._decode_waiting(messages)
        messages += self._fix.overdue(t_ns, at_end=True)
        return messages

    def _frame(self, frame: Frame) -> Sequence[Message]:
        plans = self._mapping.find(frame.arbitration_id, frame.extended)
        if plans:
            return self._planned(frame, plans)
        if self._transport is None or not frame.extended:
            return ()
        whole = self._transport.take(frame)
        return () if whole is None else self._frame(whole)

    def _planned(self, frame: Frame, plans: Sequence[FramePlan]) -> Sequence[Message]:
        if self._clock.offset_ns is None and not self._clock_is_told(frame, plans):
            return ()
        messages: list[Message] = []
        if self._waiting:
            self._decode_waiting(messages)
        for plan in plans:
            self._decode(frame, plan, messages)
        return messages

    def _decode_waiting(self, messages: list[Message]) -> None:
        waited, self._waiting = self._waiting, []
        for held in waited:
            for plan in self._mapping.find(held.arbitration_id, held.extended):
                self._decode(held, plan, messages)

    def _clock_is_told(self, frame: Frame, plans: Sequence[FramePlan]) -> bool:
        for plan in plans:
            value_s = clock_value_s(plan, frame.data, self._latest)
            if value_s is not None:
                self._clock.hear(round(value_s * 1e9), frame.t_ns)
                if not self.has_no_time:
                    return True
        if len(self._waiting) < MOST_WAITING:
            self._waiting.append(frame)
        else:
            self.dropped += 1
        return False

    def _decode(self, frame: Frame, plan: FramePlan, messages: list[Message]) -> None:
        """Add the messages that a frame makes, and the fix before it if that is overdue."""
        t_ns = self._steady.steady(frame.t_ns + (self._clock.offset_ns or 0))
        if not EARLIEST_NS <= t_ns <= LATEST_NS:
            self._out_of_bounds += 1
            return
        if self._has_fix:
            messages += self._fix.overdue(t_ns)
        signals = plan.decode(frame.data)
        if not signals:
            return
        for name in plan.kept:
            if name in signals:
                self._latest[plan.name, name] = signals[name]
        for topic, latency_ns, extractors in plan.outputs:
            fields = self._fields(extractors, signals, t_ns, frame.arbitration_id)
            if fields is not None and topic is not None:
                messages.append(topic(t_ns=t_ns - latency_ns if t_ns > latency_ns else 0, **fields))
        if plan.fix_extractors:
            self._add_to_fix(plan, signals, t_ns, messages)

    def _add_to_fix(
        self, plan: FramePlan, signals: Signals, t_ns: int, messages: list[Message]
    ) -> None:
        """Add what the frame holds of a fix, and the fix where that makes it whole."""
        for extractor in plan.fix_extractors:
            if extractor.is_held_by(signals):
                value = extractor.read(signals, self._latest)
                if extractor.rank is None or self._admits(extractor, value, t_ns):
                    messages += self._fix.take(plan.name, extractor, value, t_ns)
        messages += self._fix.if_complete()

    def _fields(
        self, extractors: Sequence[Extractor], signals: Signals, t_ns: int, unit: int
    ) -> Fields | None:
        """Fields of one message; None where the frame holds nothing of it."""
        fields: Fields = {}
        is_held = False
        for extractor in extractors:
            value = extractor.read(signals, self._latest)
            if value is None and not extractor.is_held_by(signals):
                continue
            if extractor.rank is not None and not self._admits(extractor, value, t_ns):
                continue
            is_held = True
            if value is None:
                continue
            if extractor.is_derived:
                self._derived.put(fields, extractor, value, t_ns, unit)
            else:
                fields[extractor.field] = value
        return fields if is_held else None

    def _admits(self, extractor: Extractor, value: Value | None, t_ns: int) -> bool:
        """Whether this place of a quantity that has several is the one that is read."""
        rank = extractor.rank or 0
        return self._preference.admits(extractor.quantity, rank, t_ns, is_known=value is not None)
