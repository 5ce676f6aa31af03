"""What a drive's sensors measured, as arrays: the input of the filters that judge and compare."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from wayline.drive import Drive
from wayline.messages import Barometer, GpsFix, Gyro, Message, Odometer, Torque
from wayline_cli.stream import DriveStream, Outage, with_outages
from wayline_evaluation.estimates import Floats


@dataclass(frozen=True, slots=True)
class Series:
    """Values of one sensor in order of time, shape (n,)."""

    times_s: Floats
    """Unix, as ingest stamped them."""
    values: Floats

    def __len__(self) -> int:
        return len(self.times_s)


@dataclass(frozen=True, slots=True)
class Sensed:
    """One drive."""

    start_s: float
    """Smallest time of any message."""
    end_s: float
    fixes: tuple[GpsFix, ...]
    """Valid ones only, in order of time."""
    speed_mps: Series
    """Of the wheels, negative where the vehicle said that it reverses."""
    yaw_rate_degps: Series
    pressure_pa: Series
    slope_pct: Series
    """The vehicle's own; empty where it reports none."""


def sense(drive: Drive, where: Path, outages: Sequence[Outage] = ()) -> Sensed:
    """Read a drive. Raises InputError."""
    arrivals = with_outages(DriveStream(drive, str(where)), outages)
    return sensed_of(arrival.message for arrival in arrivals)


def sensed_of(messages: Iterable[Message]) -> Sensed:
    """Sort messages by sensor and time."""
    kinds: dict[type[Message], list[Message]] = {}
    for message in messages:
        kinds.setdefault(type(message), []).append(message)
    times_ns = [message.t_ns for each in kinds.values() for message in each]
    found = (message for message in kinds.get(GpsFix, ()) if isinstance(message, GpsFix))
    fixes = sorted((fix for fix in found if fix.valid), key=lambda fix: fix.t_ns)
    return Sensed(
        start_s=min(times_ns, default=0) * 1e-9,
        end_s=max(times_ns, default=0) * 1e-9,
        fixes=tuple(fixes),
        speed_mps=_speeds(kinds.get(Odometer, [])),
        yaw_rate_degps=_series(kinds.get(Gyro, []), lambda m: getattr(m, "yaw_rate_degps", None)),
        pressure_pa=_series(kinds.get(Barometer, []), lambda m: getattr(m, "pressure_pa", None)),
        slope_pct=_series(kinds.get(Torque, []), lambda m: getattr(m, "slope_pct", None)),
    )


def _speeds(messages: Sequence[Message]) -> Series:
    backwards = False

    def signed(message: Message) -> float | None:
        nonlocal backwards
        if not isinstance(message, Odometer):
            return None
        if message.reverse is not None:
            backwards = message.reverse
        if message.speed_mps is None:
            return None
        return -message.speed_mps if backwards else message.speed_mps

    return _series(messages, signed)


def _series(messages: Sequence[Message], value: Callable[[Message], float | None]) -> Series:
    rows = [(m.t_ns, v) for m in messages if (v := value(m)) is not None]
    times_s = np.array([t_ns for t_ns, _ in rows], dtype=np.float64) * 1e-9
    values = np.array([v for _, v in rows], dtype=np.float64)
    order = np.argsort(times_s, kind="stable")
    return Series(times_s[order], values[order])
