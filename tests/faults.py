"""Faults of a drive, made by filtering its messages. Seconds count from the drive's first one."""

import random
from collections.abc import Callable, Iterator
from typing import Any

import msgspec

from wayline.geo import LocalPlane
from wayline.messages import GpsFix, Gyro, Message, Odometer

Fault = Callable[[list[Message], int], list[Message]]
"""From messages in order of arrival and the instant at which the drive began."""
Span = tuple[float, float]


def without(kinds: tuple[type[Message], ...], span: Span) -> Fault:
    """Nothing of these kinds arrives."""

    def fault(messages: list[Message], start_ns: int) -> list[Message]:
        return [m for m in messages if not (isinstance(m, kinds) and _in(m, start_ns, span))]

    return fault


def tunnel(span: Span) -> Fault:
    """The receiver goes on and says that it sees nothing."""
    return _each(GpsFix, span, lambda fix: GpsFix(t_ns=fix.t_ns, valid=False, mode=1, satellites=0))


def displaced(span: Span, east_m: float, north_m: float) -> Fault:
    """Fixes lie elsewhere, and the receiver is as sure as ever."""

    def moved(fix: GpsFix) -> GpsFix:
        if fix.lat_deg is None or fix.lon_deg is None:
            return fix
        lat_deg, lon_deg = LocalPlane(fix.lat_deg, fix.lon_deg).to_geodetic(east_m, north_m)
        return msgspec.structs.replace(fix, lat_deg=lat_deg, lon_deg=lon_deg)

    return _each(GpsFix, span, moved)


def receiver_frozen(span: Span) -> Fault:
    """The receiver tells its last fix again and again, each time with a new time."""

    def fault(messages: list[Message], start_ns: int) -> list[Message]:
        last: GpsFix | None = None
        out: list[Message] = []
        for message in messages:
            if isinstance(message, GpsFix) and message.valid:
                if last is not None and _in(message, start_ns, span):
                    out.append(msgspec.structs.replace(last, t_ns=message.t_ns))
                    continue
                last = message
            out.append(message)
        return out

    return fault


def gyro_reads(span: Span, yaw_rate_degps: float) -> Fault:
    """The gyro is stuck at a rate, or sees a spike of it."""
    return _each(Gyro, span, lambda gyro: Gyro(t_ns=gyro.t_ns, yaw_rate_degps=yaw_rate_degps))


def wheels_read(span: Span, scale: float, offset_mps: float = 0.0) -> Fault:
    """Wheels lock, spin, or have another size."""

    def wrong(wheels: Odometer) -> Odometer:
        if wheels.speed_mps is None:
            return wheels
        speed_mps = scale * wheels.speed_mps + offset_mps
        return msgspec.structs.replace(wheels, speed_mps=speed_mps)

    return _each(Odometer, span, wrong)


def duplicated(messages: list[Message], start_ns: int) -> list[Message]:
    """Everything arrives twice."""
    return [message for message in messages for _ in range(2)]


def out_of_order(kinds: tuple[type[Message], ...], most_s: float, seed: int = 1) -> Fault:
    """Messages of these kinds arrive up to so much later than they should, each on its own."""

    def fault(messages: list[Message], start_ns: int) -> list[Message]:
        chance = random.Random(seed)
        arrivals_ns: Iterator[float] = (
            m.t_ns + (chance.uniform(0.0, most_s * 1e9) if isinstance(m, kinds) else 0.0)
            for m in messages
        )
        order = sorted(zip(arrivals_ns, range(len(messages)), strict=True))
        return [messages[place] for _, place in order]

    return fault


def clock_stepped(at_s: float, by_s: float) -> Fault:
    """From an instant on every time is off by so much."""

    def fault(messages: list[Message], start_ns: int) -> list[Message]:
        return [
            msgspec.structs.replace(m, t_ns=m.t_ns + round(by_s * 1e9))
            if _in(m, start_ns, (at_s, float("inf")))
            else m
            for m in messages
        ]

    return fault


def _each(kind: type[Message], span: Span, change: Callable[[Any], Message]) -> Fault:
    def fault(messages: list[Message], start_ns: int) -> list[Message]:
        return [
            change(m) if isinstance(m, kind) and _in(m, start_ns, span) else m for m in messages
        ]

    return fault


def _in(message: Message, start_ns: int, span: Span) -> bool:
    return span[0] <= (message.t_ns - start_ns) * 1e-9 < span[1]
