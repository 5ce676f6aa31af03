"""Trips on a plane, made of legs, as a receiver at 1 Hz would tell them."""

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import msgspec
import numpy as np

from builders import fix
from wayline.geo import LocalPlane
from wayline.messages import GpsFix, Message, Odometer, Pose
from wayline.trip_distance.trip import TripDistance, TripMeter

PLANE = LocalPlane(56.0, 10.0)


class Leg(NamedTuple):
    """So long in a direction, at one speed; 0 m/s is a stop."""

    seconds: int
    course_deg: float
    speed_mps: float


def journey(
    legs: Sequence[Leg],
    *,
    position_std_m: float = 0.0,
    speed_std_mps: float = 0.0,
    tells_speed: bool = True,
    seed: int = 1,
    **fields: Any,
) -> list[GpsFix]:
    """A fix a second; a leg's speed and course hold from its first second on."""
    random = np.random.default_rng(seed)
    east_m = north_m = 0.0
    made, second = [], 0
    for leg in legs:
        for _ in range(leg.seconds):
            off_m = position_std_m * random.normal(size=2)
            lat_deg, lon_deg = PLANE.to_geodetic(east_m + off_m[0], north_m + off_m[1])
            told_mps = abs(leg.speed_mps + speed_std_mps * random.normal())
            told = {"speed_mps": told_mps if tells_speed else None, "course_deg": leg.course_deg}
            made.append(fix(second, lat_deg, lon_deg, **told, **fields))
            east_m += leg.speed_mps * math.sin(math.radians(leg.course_deg))
            north_m += leg.speed_mps * math.cos(math.radians(leg.course_deg))
            second += 1
    return made


def with_hole(fixes: Sequence[GpsFix], first: int, end: int) -> list[GpsFix]:
    """Without the fixes from one second up to another."""
    return [*fixes[:first], *fixes[end:]]


def moved(one: GpsFix, north_deg: float, **fields: Any) -> GpsFix:
    """A fix somewhere else."""
    assert one.lat_deg is not None
    return msgspec.structs.replace(one, lat_deg=one.lat_deg + north_deg, **fields)


def metered(messages: Sequence[Message], **options: Any) -> TripDistance:
    """What a meter says at the end of them."""
    meter = TripMeter(**options)
    for message in messages:
        assert isinstance(message, GpsFix | Odometer | Pose)
        meter.take(message)
    told = meter.distance()
    assert told is not None
    return told
