"""Pure: CAN frames in, odometer, gyro, torque, barometer and gps_fix messages out."""

from collections.abc import Iterator, Sequence
from typing import ClassVar

import msgspec

from wayline.clock import SteadyClock
from wayline.drive import CanMapping, Vehicle
from wayline.inputs import Flush, Frame, Tick
from wayline.messages import TOPICS, Message
from wayline_can_ingest.fix import SpreadFix
from wayline_can_ingest.mapping import FramePlan, Mapping
from wayline_can_ingest.quantity import Value

MOST_WAITING = 100_000
"""Frames held until the source's clock signal has said what time it is."""


class CanIngestCore:
    """Translates the frames of one `[[can]]` source of one vehicle.

    Every `t_ns` has the source's clock offset added and the mapping's and receiver's latency
    taken off. Frames that nothing maps cost one look-up.
    """

    reads: ClassVar[frozenset[type[Message]]] = frozenset()
    period_ns: ClassVar[int | None] = None

    def __init__(
        self,
        source: CanMapping,
        mapping: Mapping,
        vehicle: Vehicle,
        *,
        channel: str | int | None = None,
    ) -> None:
        self._source = source
        self._channel = None if channel is None else str(channel)
        self._mapping = mapping
        self._reference_torque_nm = vehicle.engine_reference_torque_nm
        self._latest: dict[tuple[str, str], float | None] = {}
        self._clock = SteadyClock()
        self._offset_ns = None if source.clock else round(source.clock_offset_s * 1e9)
        self._waiting: list[Frame] = []
        self._wraps: dict[str, Unwrapped] = {}
        self._fix = SpreadFix(mapping.gps_fields, round(vehicle.gps_latency_s * 1e9))
        self.dropped = 0
        """Frames that came before the clock signal and did not fit the waiting room."""

    @property
    def bad_input(self) -> int:
        """How often the source's clock stepped back."""
        return self._clock.steps

    def arrival_ns(self, frame: Frame) -> int:
        """When a frame arrived, on the clock that the messages carry."""
        return frame.t_ns + (self._offset_ns or 0)

    def handle(self, message: msgspec.Struct, source: str) -> Sequence[Message]:
        """Take a Frame, Tick or Flush; return the bus messages that it completes."""
        del source
        if isinstance(message, Frame):
            return self._frame(message)
        if isinstance(message, Tick | Flush):
            return self._fix.overdue(message.t_ns, at_end=isinstance(message, Flush))
        return ()

    def _frame(self, frame: Frame) -> Sequence[Message]:
        plan = self._mapping.find(frame)
        if plan is None or (self._channel is not None and frame.channel != self._channel):
            return ()
        if self._offset_ns is None:
            return self._await_clock(frame, plan)
        return list(self._decoded(frame, plan, self._offset_ns))

    def _await_clock(self, frame: Frame, plan: FramePlan) -> Sequence[Message]:
        value = self._clock_value(frame, plan)
        if value is None:
            if len(self._waiting) < MOST_WAITING:
                self._waiting.append(frame)
            else:
                self.dropped += 1
            return ()
        self._offset_ns = round(value * 1e9) - frame.t_ns
        waited, self._waiting = [*self._waiting, frame], []
        return [message for held in waited for message in self._frame(held)]

    def _clock_value(self, frame: Frame, plan: FramePlan) -> float | None:
        clock = self._source.clock
        if clock is None or plan.name != clock.message:
            return None
        return plan.decode(frame).get(clock.signal)

    def _decoded(self, frame: Frame, plan: FramePlan, offset_ns: int) -> Iterator[Message]:
        t_ns = self._clock.steady(frame.t_ns + offset_ns)
        signals = plan.decode(frame)
        if not signals:
            return
        for name in plan.kept:
            if name in signals:
                self._latest[plan.name, name] = signals[name]
        fields: dict[str, dict[str, Value]] = {}
        instants: dict[str, int] = {}
        fixed = False
        for extractor in plan.extractors:
            value = extractor.read(signals, self._latest)
            if extractor.topic == "gps_fix":
                yield from self._fix.take(plan.name, extractor, value, t_ns)
                fixed = True
                continue
            if any(name not in signals for name in extractor.signals):
                continue
            fields.setdefault(extractor.topic, {})
            instants.setdefault(extractor.topic, t_ns - extractor.latency_ns)
            if value is not None:
                self._put(fields[extractor.topic], extractor.field, value, plan)
        for topic, values in fields.items():
            if topic != "vehicle":
                yield TOPICS[topic](t_ns=instants[topic], **values)
        if fixed:
            yield from self._fix.if_complete()

    def _put(self, fields: dict[str, Value], field: str, value: Value, plan: FramePlan) -> None:
        """Set one field of a message, deriving what the bus gives in another form."""
        if field == "engine_reference_torque_nm":
            self._reference_torque_nm = float(value) or None
        elif field == "engine_torque_pct":
            if self._reference_torque_nm is not None and "engine_torque_nm" not in fields:
                fields["engine_torque_nm"] = float(value) / 100.0 * self._reference_torque_nm
        elif field == "distance_m":
            unwrapped = self._wraps.setdefault(plan.name, Unwrapped(plan.counter_span_m(field)))
            fields[field] = unwrapped.distance_m(float(value))
        elif field == "speed_mps" and float(value) < 0.0:
            fields[field] = -float(value)
            fields.setdefault("reverse", True)
        else:
            fields[field] = value


class Unwrapped:
    """A distance counter whose wraps are taken out."""

    def __init__(self, span_m: float) -> None:
        self._span_m = span_m
        self._last_m: float | None = None
        self._turns = 0

    def distance_m(self, counted_m: float) -> float:
        """The cumulative distance; a fall by more than half the counter's span is a wrap."""
        if self._last_m is not None and self._last_m - counted_m > self._span_m / 2.0:
            self._turns += 1
        self._last_m = counted_m
        return counted_m + self._turns * self._span_m
