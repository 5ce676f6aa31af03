"""Pure: what each sensor measures of the horizontal filter's state, linearised at it.

papers/001 lists the measurements ("GPS derived heading, velocity and position") in words.
"""

import math

import numpy as np

from wayline.geo import wrap_pi
from wayline.likelihood import Measurement
from wayline_fusion.filter.states import SIZE, Floats, States

S = States


def position(
    x: Floats, east_m: float, north_m: float, slow_std_m: float, white_std_m: float
) -> Measurement:
    """GPS position of the instant LATENCY ago; a part of its error varies slowly (shaping)."""
    sin, cos = math.sin(x[S.HEADING]), math.cos(x[S.HEADING])
    wheels_mps, scale, latency_s = x[S.WHEEL_SPEED], x[S.ODOMETER_SCALE], x[S.LATENCY]
    speed_mps = scale * wheels_mps
    late_m = speed_mps * latency_s
    H = np.zeros((2, SIZE))
    H[0, S.EAST] = H[1, S.NORTH] = 1.0
    H[0, S.GPS_EAST] = H[1, S.GPS_NORTH] = slow_std_m
    by_wheels, by_scale = scale * latency_s, wheels_mps * latency_s
    H[0, S.WHEEL_SPEED], H[1, S.WHEEL_SPEED] = -sin * by_wheels, -cos * by_wheels
    H[0, S.ODOMETER_SCALE], H[1, S.ODOMETER_SCALE] = -sin * by_scale, -cos * by_scale
    H[0, S.HEADING], H[1, S.HEADING] = -cos * late_m, sin * late_m
    H[0, S.LATENCY], H[1, S.LATENCY] = -sin * speed_mps, -cos * speed_mps
    expected_east_m = x[S.EAST] + slow_std_m * x[S.GPS_EAST] - sin * late_m
    expected_north_m = x[S.NORTH] + slow_std_m * x[S.GPS_NORTH] - cos * late_m
    y = np.array([east_m - expected_east_m, north_m - expected_north_m])
    return Measurement("gps_position", y, H, np.diag([white_std_m**2, white_std_m**2]))


def gps_speed(x: Floats, speed_mps: float, std_mps: float) -> Measurement:
    """GPS speed over ground, which has no sign.

    Of LATENCY it tells too little: an acceleration that is estimated from speeds is wrong as they
    are, and what both share would seem to be one.
    """
    wheels_mps, scale = x[S.WHEEL_SPEED], x[S.ODOMETER_SCALE]
    signed_scale = -scale if wheels_mps < 0.0 else scale
    by_state = {S.WHEEL_SPEED: signed_scale, S.ODOMETER_SCALE: abs(wheels_mps)}
    return _scalar("gps_speed", speed_mps - signed_scale * wheels_mps, by_state, std_mps)


def course(x: Floats, course_rad: float, std_rad: float, rate_radps: float) -> Measurement:
    """GPS course over ground LATENCY ago: the heading then, or its opposite in reverse."""
    heading = x[S.HEADING] + (math.pi if x[S.WHEEL_SPEED] < 0.0 else 0.0)
    expected = heading - rate_radps * x[S.LATENCY] + x[S.COURSE_BIAS]
    by_state = {S.HEADING: 1.0, S.LATENCY: -rate_radps, S.COURSE_BIAS: 1.0}
    return _scalar("gps_course", wrap_pi(course_rad - expected), by_state, std_rad)


def odometer(x: Floats, speed_mps: float, std_mps: float) -> Measurement:
    """Wheel speed with sign."""
    off_mps = speed_mps - float(x[S.WHEEL_SPEED])
    return _scalar("odometer", off_mps, {S.WHEEL_SPEED: 1.0}, std_mps)


def still(x: Floats, std_mps: float) -> Measurement:
    """Zero velocity."""
    return _scalar("standstill", -x[S.WHEEL_SPEED], {S.WHEEL_SPEED: 1.0}, std_mps)


def still_rate(x: Floats, rate_radps: float, std_radps: float) -> Measurement:
    """What the gyro reads at standstill is its bias."""
    return _scalar("standstill_gyro", rate_radps - x[S.GYRO_BIAS], {S.GYRO_BIAS: 1.0}, std_radps)


def _scalar(sensor: str, y: float, by_state: dict[int, float], std: float) -> Measurement:
    # numpy makes an array of zeros in a third of the time that it takes for one of a list
    innovation, H, R = np.zeros(1), np.zeros((1, SIZE)), np.zeros((1, 1))
    innovation[0], R[0, 0] = y, std**2
    for state, derivative in by_state.items():
        H[0, state] = derivative
    return Measurement(sensor, innovation, H, R)
