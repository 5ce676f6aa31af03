"""Closed-form drives with perfect or imperfect sensors, as messages in order of arrival."""

import math
from collections.abc import Callable, Iterator
from typing import NamedTuple

import numpy as np

from builders import at, fix, gyro, odometer
from wayline.geo import LocalPlane, wrap_360
from wayline.messages import Message

ORIGIN = LocalPlane(56.0, 10.0)
STEP_S = 0.01


class Sensors(NamedTuple):
    """What is wrong with the sensors."""

    gyro_bias_degps: float = 0.0
    gyro_scale: float = 1.0
    odometer_scale: float = 1.0
    gps_noise_m: float = 0.0
    latency_s: float = 0.0
    """Fixes arrive this late, with the time at which they were true."""
    outage: tuple[float, float] = (math.inf, math.inf)


class Truth(NamedTuple):
    """Where the vehicle is."""

    seconds: float
    east_m: float
    north_m: float
    heading_deg: float
    speed_mps: float


Motion = Callable[[float], tuple[float, float]]
"""Speed (m/s) and yaw rate (deg/s) at a time."""


def circle(seconds: float) -> tuple[float, float]:
    del seconds
    return 15.0, 5.0


def town(seconds: float) -> tuple[float, float]:
    """20 s of standing, then driving with bends and stops."""
    if seconds < 20.0 or 100.0 <= seconds % 120.0 < 110.0:
        return 0.0, 0.0
    return 12.0 + 3.0 * math.sin(seconds / 9.0), 12.0 * math.sin(seconds / 7.0)


def truth_of(motion: Motion, duration_s: float) -> list[Truth]:
    east_m = north_m = heading_deg = 0.0
    truths = []
    for step in range(round(duration_s / STEP_S)):
        seconds = step * STEP_S
        speed_mps, rate_degps = motion(seconds)
        truths.append(Truth(seconds, east_m, north_m, wrap_360(heading_deg), speed_mps))
        middle_rad = math.radians(heading_deg + 0.5 * rate_degps * STEP_S)
        east_m += speed_mps * STEP_S * math.sin(middle_rad)
        north_m += speed_mps * STEP_S * math.cos(middle_rad)
        heading_deg += rate_degps * STEP_S
    return truths


def messages_of(
    motion: Motion, truths: list[Truth], sensors: Sensors, seed: int = 1
) -> Iterator[Message]:
    """Gyro at 100 Hz, odometer at 10 Hz, GPS at 1 Hz."""
    rng = np.random.default_rng(seed)
    late: list[tuple[float, Message]] = []
    for step, truth in enumerate(truths):
        while late and late[0][0] <= truth.seconds + 1e-9:
            yield late.pop(0)[1]
        _, rate_degps = motion(truth.seconds)
        yield gyro(truth.seconds, rate_degps / sensors.gyro_scale + sensors.gyro_bias_degps)
        if step % 10 == 0:
            yield odometer(truth.seconds, truth.speed_mps / sensors.odometer_scale)
        if step % 100 == 0 and not sensors.outage[0] <= truth.seconds < sensors.outage[1]:
            east, north = rng.normal(0.0, sensors.gps_noise_m or 1e-9, 2)
            lat_deg, lon_deg = ORIGIN.to_geodetic(truth.east_m + east, truth.north_m + north)
            moving = truth.speed_mps > 0.0
            late.append(
                (
                    truth.seconds + sensors.latency_s,
                    fix(
                        truth.seconds,
                        lat_deg,
                        lon_deg,
                        speed_mps=truth.speed_mps,
                        course_deg=truth.heading_deg if moving else None,
                        h_std_m=max(sensors.gps_noise_m, 1.0),
                        satellites=9,
                    ),
                )
            )


def seconds_of(t_ns: int) -> float:
    return (t_ns - at(0.0)) * 1e-9
