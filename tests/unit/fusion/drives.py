"""Closed-form drives with perfect or imperfect sensors, as messages in order of arrival."""

import math
from collections.abc import Callable, Iterable, Iterator
from typing import NamedTuple

import msgspec
import numpy as np

from builders import at, fix, gyro, odometer
from wayline.geo import LocalPlane, wrap_180, wrap_360
from wayline.messages import GpsFix, Message, Odometer, Pose

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
    odometer_hz: int = 10
    speed_step_mps: float = 0.0
    """Wheel speeds are rounded to steps of this; so are yaw rates below."""
    rate_step_degps: float = 0.0


class Truth(NamedTuple):
    """Where the vehicle is."""

    seconds: float
    east_m: float
    north_m: float
    heading_deg: float
    speed_mps: float
    path_m: float
    """Driven so far, in either direction."""


Motion = Callable[[float], tuple[float, float]]
"""Speed (m/s) and yaw rate (deg/s) at a time."""


def circle(seconds: float) -> tuple[float, float]:
    del seconds
    return 15.0, 5.0


def straight(seconds: float) -> tuple[float, float]:
    del seconds
    return 20.0, 0.0


def figure_eight(seconds: float) -> tuple[float, float]:
    """A right turn, then as far round to the left."""
    return 10.0, 9.1 if seconds % 80.0 < 40.0 else -9.1


def stop_and_go(seconds: float) -> tuple[float, float]:
    """Along a straight road, every 40 s: stand for 10 s, then up to 12 m/s and down again."""
    moving_s = max(seconds % 40.0 - 10.0, 0.0)
    return min(2.0 * moving_s, 12.0, 2.0 * (30.0 - moving_s)), 0.0


def winding(seconds: float) -> tuple[float, float]:
    """A country road, slower and faster, left and right."""
    return 15.0 + 3.0 * math.sin(seconds / 9.0), 12.0 * math.sin(seconds / 7.0)


def spiral_down(seconds: float) -> tuple[float, float]:
    """A ramp of 14 m radius; the approach to it is straight."""
    return 5.0, 0.0 if seconds < 20.0 else 19.9


def town(seconds: float) -> tuple[float, float]:
    """20 s of standing, then driving with bends and stops."""
    if seconds < 20.0 or 100.0 <= seconds % 120.0 < 110.0:
        return 0.0, 0.0
    return 12.0 + 3.0 * math.sin(seconds / 9.0), 12.0 * math.sin(seconds / 7.0)


def truth_of(motion: Motion, duration_s: float) -> list[Truth]:
    east_m = north_m = heading_deg = path_m = 0.0
    truths = []
    for step in range(round(duration_s / STEP_S)):
        seconds = step * STEP_S
        speed_mps, rate_degps = motion(seconds)
        truths.append(Truth(seconds, east_m, north_m, wrap_360(heading_deg), speed_mps, path_m))
        middle_rad = math.radians(heading_deg + 0.5 * rate_degps * STEP_S)
        east_m += speed_mps * STEP_S * math.sin(middle_rad)
        north_m += speed_mps * STEP_S * math.cos(middle_rad)
        heading_deg += rate_degps * STEP_S
        path_m += abs(speed_mps) * STEP_S
    return truths


def messages_of(
    motion: Motion, truths: list[Truth], sensors: Sensors, seed: int = 1
) -> Iterator[Message]:
    """Gyro at 100 Hz, odometer at 10 Hz or as told, GPS at 1 Hz."""
    rng = np.random.default_rng(seed)
    late: list[tuple[float, Message]] = []
    for step, truth in enumerate(truths):
        while late and late[0][0] <= truth.seconds + 1e-9:
            yield late.pop(0)[1]
        _, rate_degps = motion(truth.seconds)
        measured_degps = rate_degps / sensors.gyro_scale + sensors.gyro_bias_degps
        yield gyro(truth.seconds, rounded(measured_degps, sensors.rate_step_degps))
        if step % (100 // sensors.odometer_hz) == 0:
            measured_mps = abs(truth.speed_mps) / sensors.odometer_scale
            reverse = truth.speed_mps < 0.0
            wheels_mps = rounded(measured_mps, sensors.speed_step_mps)
            yield odometer(truth.seconds, wheels_mps, reverse=reverse)
        if step % 100 == 0 and not sensors.outage[0] <= truth.seconds < sensors.outage[1]:
            east, north = rng.normal(0.0, sensors.gps_noise_m or 1e-9, 2)
            lat_deg, lon_deg = ORIGIN.to_geodetic(truth.east_m + east, truth.north_m + north)
            course_deg = wrap_360(truth.heading_deg + (180.0 if truth.speed_mps < 0.0 else 0.0))
            late.append(
                (
                    truth.seconds + sensors.latency_s,
                    fix(
                        truth.seconds,
                        lat_deg,
                        lon_deg,
                        speed_mps=abs(truth.speed_mps),
                        course_deg=course_deg if truth.speed_mps else None,
                        h_std_m=max(sensors.gps_noise_m, 1.0),
                        satellites=9,
                    ),
                )
            )


def noisy(
    messages: Iterable[Message], wheels_mps: float, doppler_mps: float, seed: int = 1
) -> Iterator[Message]:
    """White noise on wheels that turn, and on Doppler along and across the way, at rest too."""
    rng = np.random.default_rng(seed)
    for message in messages:
        if isinstance(message, Odometer) and message.speed_mps:
            speed_mps = max(message.speed_mps + rng.normal(0.0, wheels_mps), 0.0)
            yield msgspec.structs.replace(message, speed_mps=speed_mps)
        elif isinstance(message, GpsFix) and message.speed_mps is not None:
            along_mps, across_mps = rng.normal(0.0, doppler_mps, 2)
            speed_mps, course_deg = abs(message.speed_mps + along_mps), message.course_deg
            if course_deg is not None:
                off_deg = math.degrees(math.atan2(across_mps, speed_mps))
                course_deg = wrap_360(course_deg + off_deg)
            yield msgspec.structs.replace(message, speed_mps=speed_mps, course_deg=course_deg)
        else:
            yield message


def rounded(value: float, step: float) -> float:
    return round(value / step) * step if step else value


def seconds_of(t_ns: int) -> float:
    return (t_ns - at(0.0)) * 1e-9


def truth_at(t_ns: int, truths: list[Truth]) -> Truth:
    return truths[round(seconds_of(t_ns) / STEP_S)]


def error_m(pose: Pose, truths: list[Truth]) -> float:
    assert pose.lat_deg is not None
    assert pose.lon_deg is not None
    truth = truth_at(pose.t_ns, truths)
    east_m, north_m = ORIGIN.to_plane(pose.lat_deg, pose.lon_deg)
    return math.hypot(east_m - truth.east_m, north_m - truth.north_m)


def heading_error_deg(pose: Pose, truths: list[Truth]) -> float:
    assert pose.heading_deg is not None
    return abs(wrap_180(pose.heading_deg - truth_at(pose.t_ns, truths).heading_deg))


def speed_error_mps(pose: Pose, truths: list[Truth]) -> float:
    assert pose.speed_mps is not None
    return abs(pose.speed_mps - truth_at(pose.t_ns, truths).speed_mps)
