"""Pure: what a drive's sensors measured, as arrays: what judging filters are fed with."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from wayline.messages import Barometer, GpsFix, Gyro, Message, Odometer, Torque
from wayline_evaluation.estimates import Floats
from wayline_replay.outages import Outage


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
    blind_s: Floats
    """How long the receiver said that it has no fix before each of them; 0 in a row of fixes."""
    speed_mps: Series
    """Of the wheels, negative where the vehicle said that it reverses."""
    yaw_rate_degps: Series
    pressure_pa: Series
    slope_pct: Series
    """The vehicle's own; empty where it reports none."""


def sensed_of(messages: Iterable[Message]) -> Sensed:
    """Sort messages by sensor and time."""
    kinds: dict[type[Message], list[Message]] = {}
    for message in messages:
        kinds.setdefault(type(message), []).append(message)
    times_ns = [message.t_ns for each in kinds.values() for message in each]
    told = [fix for fix in kinds.get(GpsFix, ()) if isinstance(fix, GpsFix) and not fix.repeat]
    told.sort(key=lambda fix: fix.t_ns)
    return Sensed(
        start_s=min(times_ns, default=0) * 1e-9,
        end_s=max(times_ns, default=0) * 1e-9,
        fixes=tuple(fix for fix in told if fix.valid),
        blind_s=_blind_s(told),
        speed_mps=_speeds(kinds.get(Odometer, [])),
        yaw_rate_degps=_series(kinds.get(Gyro, []), lambda m: getattr(m, "yaw_rate_degps", None)),
        pressure_pa=_series(kinds.get(Barometer, []), lambda m: getattr(m, "pressure_pa", None)),
        slope_pct=_series(kinds.get(Torque, []), lambda m: getattr(m, "slope_pct", None)),
    )


def without_fixes(sensed: Sensed, outages: Sequence[Outage]) -> Sensed:
    """A drive with GPS taken away; the receiver itself was never blind then."""
    since_s = np.array([fix.t_ns for fix in sensed.fixes], dtype=np.float64) * 1e-9 - sensed.start_s
    kept = np.ones(len(sensed.fixes), dtype=np.bool_)
    for outage in outages:
        end_s = outage.start_s + outage.length_s
        kept &= (since_s < outage.start_s) | (since_s >= end_s)
    fixes = tuple(fix for fix, stays in zip(sensed.fixes, kept, strict=True) if stays)
    return replace(sensed, fixes=fixes, blind_s=sensed.blind_s[kept])


def without_speeds(sensed: Sensed, spoilt: NDArray[np.bool_]) -> Sensed:
    """A drive with some of the wheels' speeds left out, shape (n,)."""
    wheels = sensed.speed_mps
    kept = Series(wheels.times_s[~spoilt], wheels.values[~spoilt])
    return replace(sensed, speed_mps=kept)


def _blind_s(told: Sequence[GpsFix]) -> Floats:
    """Since the last valid fix, where the receiver told of its blindness in between."""
    found: list[float] = []
    last_ns, blind = None, False
    for fix in told:
        if not fix.valid:
            blind = True
            continue
        found.append((fix.t_ns - last_ns) * 1e-9 if blind and last_ns is not None else 0.0)
        last_ns, blind = fix.t_ns, False
    return np.array(found, dtype=np.float64)


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
