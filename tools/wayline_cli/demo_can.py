"""Pure: what the demo car's CAN bus carries: yaw rate, wheel speed and air pressure."""

import heapq
import struct
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wayline.air import EXPONENT, SCALE_M, SEA_LEVEL_PA
from wayline_cli.demo_motion import Motion

Floats = NDArray[np.float64]

GYRO_BIAS_DEGPS = 0.6
GYRO_STD_DEGPS = 0.08
SPEED_READS = 1.03
"""The speedometer reads so many times the true speed, as worn tyres make it."""
BAROMETER_OFF_M = 35.0
"""Weather: the standard atmosphere's altitude is this much above the true one."""
PRESSURE_STEP_PA = 10
GYRO_EVERY, WHEELS_EVERY, AIR_EVERY = 1, 5, 25
"""Frames at 50, 10 and 2 Hz, in instants of a motion of 50 Hz."""
YAW_ID, WHEELS_ID, AIR_ID = 0x1A0, 0x1B0, 0x3C0

DBC = f"""VERSION ""

NS_ :

BS_:

BU_: CAR

BO_ {YAW_ID} Yaw: 2 CAR
 SG_ YawRate : 0|16@1- (0.01,0) [-327.68|327.67] "deg/s" WAYLINE

BO_ {WHEELS_ID} Wheels: 2 CAR
 SG_ Speed : 0|16@1+ (0.01,0) [0|655.35] "km/h" WAYLINE

BO_ {AIR_ID} Air: 2 CAR
 SG_ Pressure : 0|16@1+ ({PRESSURE_STEP_PA},0) [0|655350] "Pa" WAYLINE

CM_ SG_ {YAW_ID} YawRate "Positive turning right";
"""


class Stream(NamedTuple):
    """One frame's id and the raw values that it carries, one each `every` instants."""

    frame_id: int
    layout: str
    every: int
    raw: NDArray[np.int64]


def can_log(motion: Motion, start_s: int, random: np.random.Generator) -> Iterator[str]:
    """Lines of a candump log; `motion` has 50 instants a second, `start_s` is Unix time."""
    streams = (gyro(motion, random), wheels(motion), air(motion))
    frames = (_frames(stream, motion.times_s) for stream in streams)
    for time_s, frame_id, data in heapq.merge(*frames):
        yield f"({start_s + time_s:.6f}) can0 {frame_id:03X}#{data.hex().upper()}"


def gyro(motion: Motion, random: np.random.Generator) -> Stream:
    """Yaw rate with a constant bias, in steps of 0.01 deg/s."""
    noise = random.normal(GYRO_BIAS_DEGPS, GYRO_STD_DEGPS, len(motion.times_s))
    return Stream(YAW_ID, "<h", GYRO_EVERY, _whole((motion.yaw_rates_degps + noise) * 100.0))


def wheels(motion: Motion) -> Stream:
    """Wheel speed with an error of scale, in steps of 0.01 km/h."""
    return Stream(WHEELS_ID, "<H", WHEELS_EVERY, _whole(motion.speeds_mps * SPEED_READS * 360.0))


def air(motion: Motion) -> Stream:
    """Air pressure of the standard atmosphere on another day's weather, in coarse steps."""
    pressures_pa = pressure_pa(motion.alts_m + BAROMETER_OFF_M)
    return Stream(AIR_ID, "<H", AIR_EVERY, _whole(pressures_pa / PRESSURE_STEP_PA))


def pressure_pa(alts_m: Floats) -> Floats:
    """Pressure of the standard atmosphere, the inverse of `wayline.air.pressure_altitude_m`."""
    return SEA_LEVEL_PA * np.power(1.0 - alts_m / SCALE_M, 1.0 / EXPONENT)


def _whole(values: Floats) -> NDArray[np.int64]:
    return np.rint(values).astype(np.int64)


def _frames(stream: Stream, times_s: Floats) -> Iterator[tuple[float, int, bytes]]:
    """Time, id and data, each stream a little after the one with a smaller id."""
    after_s = (stream.frame_id - YAW_ID) * 1e-5
    for time_s, raw in zip(
        times_s[:: stream.every] + after_s, stream.raw[:: stream.every], strict=True
    ):
        yield float(time_s), stream.frame_id, struct.pack(stream.layout, int(raw))
