"""Pure: what a mapping makes of frames: which quantities come how often, in which range."""

from collections.abc import Iterable, Sequence
from typing import NamedTuple

from wayline.drive import CanMapping, Vehicle
from wayline.inputs import Flush, Frame
from wayline.messages import Message
from wayline_can_ingest.core import CanIngestCore
from wayline_can_ingest.mapping import Mapping
from wayline_can_ingest.plan import FramePlan

WANTED = (
    "odometer.speed_mps",
    "odometer.distance_m",
    "gyro.yaw_rate_degps",
    "torque.engine_torque_nm",
    "torque.engine_speed_rpm",
    "torque.gear",
    "torque.brake",
    "barometer.pressure_pa",
    "gps_fix.lat_deg",
    "gps_fix.alt_m",
)
"""What Wayline makes most of; what else is mapped is shown as well."""
UNINTERESTING = ("t_ns", "repeat", "speed_derived")
SHORTEST_S = 1e-3
LARGE = 1e6
"""From here on decimals are of no interest."""


class Arriving(NamedTuple):
    """A quantity as it comes."""

    quantity: str
    rate_hz: float
    values: str
    """From the least to the most, or the words."""


class Fit(NamedTuple):
    """How a mapping fits what was heard."""

    name: str
    seen: int
    mapped: int
    """Messages of its databases that it reads, and how many of them came."""
    arriving: tuple[Arriving, ...] = ()
    empty: tuple[str, ...] = ()
    """Quantities whose frames come without a value: not available, invalid or out of bounds."""

    @property
    def share_pct(self) -> float:
        """Of its frames, how many came at all."""
        return 100.0 * self.seen / self.mapped if self.mapped else 0.0


def share_of(name: str, mapping: Mapping, frames: Iterable[Frame]) -> Fit:
    """How many of a mapping's frames are there."""
    every = {plan.name for plans in mapping.plans.values() for plan in plans}
    return Fit(name, len({plan.name for plan in _plans_in(mapping, frames)}), len(every))


def _plans_in(mapping: Mapping, frames: Iterable[Frame]) -> set[FramePlan]:
    identifiers = {(each.arbitration_id, each.extended) for each in frames}
    return {plan for identifier in identifiers for plan in mapping.find(*identifier)}


def with_quantities(fit: Fit, mapping: Mapping, frames: Sequence[Frame]) -> Fit:
    """A fit with what can-ingest's own core makes of the frames by its mapping."""
    core = CanIngestCore(CanMapping(), mapping, Vehicle())
    messages = [message for frame in frames for message in core.handle(frame, fit.name)]
    messages += core.handle(Flush(0), fit.name)
    arriving = tuple(arrivals(messages, duration_s(frames)))
    come = {each.quantity for each in arriving}
    mapped = {
        extractor.quantity.replace("torque_pct", "torque_nm")
        for plan in _plans_in(mapping, frames)
        for extractor in plan.extractors
    }
    shown = {each for each in mapped if not each.startswith(("vehicle.", "clock."))}
    return fit._replace(arriving=arriving, empty=tuple(sorted(shown - come)))


def duration_s(frames: Sequence[Frame]) -> float:
    """From the first frame to the last."""
    return max((frames[-1].t_ns - frames[0].t_ns) * 1e-9, SHORTEST_S) if frames else 0.0


def arrivals(messages: Iterable[Message], lasted_s: float) -> list[Arriving]:
    """How often each quantity came, and between which values."""
    values: dict[str, list[object]] = {}
    for message in messages:
        for field in message.__struct_fields__:
            value = getattr(message, field)
            if value is not None and field not in UNINTERESTING:
                values.setdefault(f"{message.topic}.{field}", []).append(value)
    rate_s = max(lasted_s, SHORTEST_S)
    return [
        Arriving(name, len(found) / rate_s, _described(found))
        for name, found in sorted(values.items())
    ]


def _described(values: Sequence[object]) -> str:
    numbers = [value for value in values if isinstance(value, int | float)]
    if len(numbers) < len(values) or isinstance(values[0], bool):
        return ", ".join(sorted({str(value).lower() for value in values}))
    least, most = min(numbers), max(numbers)
    return _number(least) if least == most else f"{_number(least)} to {_number(most)}"


def _number(value: float) -> str:
    """Digits that a person wants: seven where a position needs them."""
    return f"{value:,.0f}" if abs(value) >= LARGE else f"{value:,.7g}"


def missing(fits: Iterable[Fit]) -> tuple[list[str], list[str]]:
    """What Wayline wants and nothing gives: those with frames but no value, those without."""
    fits = list(fits)
    come = {each.quantity for fit in fits for each in fit.arriving}
    empty = sorted({each for fit in fits for each in fit.empty} - come)
    return empty, [each for each in WANTED if each not in come and each not in empty]
