"""Pure: what the yardstick estimates, and what it knows of it before the first fix."""

import math
from enum import IntEnum

import numpy as np

from wayline_evaluation.estimates import Floats
from wayline_simulator.gps_model import GpsModel
from wayline_simulator.gyro import GyroModel
from wayline_simulator.happenings import Happenings
from wayline_simulator.odometer import OdometerModel

UNKNOWN_M = 1e5
TYRES_STD = 0.001
"""What warmth and speed leave of a tyre's radius over a drive: 22 K and 0.2 % in
`wayline_simulator.tyres`. A second source of slow wander beside the sensor's own."""


class YardstickStates(IntEnum):
    """Places in the state, with the unit of each; the models say what each is."""

    EAST = 0  # m
    NORTH = 1  # m
    HEADING = 2  # rad, of the grid
    GYRO_BIAS = 3  # deg/s
    GYRO_WANDER = 4  # deg/s
    GYRO_WARMTH = 5  # deg/s per kelvin
    GYRO_ROUNDING = 6  # deg/s
    GYRO_SCALE = 7  # true over measured
    WHEEL_SCALE = 8  # true over measured
    WHEEL_WANDER = 9
    WHEEL_SLIP = 10
    WHEEL_NOISE = 11  # m/s, to be added to the measured speed
    GPS_EAST = 12  # m at a HDOP of 1
    GPS_NORTH = 13
    COLD_EAST = 14  # m
    COLD_NORTH = 15
    REFLECTED_EAST = 16  # share of what a canyon's walls do
    REFLECTED_NORTH = 17


S = YardstickStates
WHEELS = (S.WHEEL_SCALE, S.WHEEL_WANDER, S.WHEEL_SLIP)
"""States whose sum is the true speed over the measured one."""
BIASES = (S.GYRO_BIAS, S.GYRO_WANDER, S.GYRO_ROUNDING)
"""In deg/s, beside what comes of warmth."""


def rounding_std_degps(gyro: GyroModel) -> float:
    """Std of what rounding adds to a moving gyro's mean as long as the rate does not change.

    First harmonic of a quantiser's error under Gaussian dither (Widrow and Kollar, Quantization
    Noise): much noise leaves nothing of it.
    """
    step_degps = gyro.resolution_degps
    noise_degps = math.hypot(
        gyro.noise_deg_per_sqrt_s * math.sqrt(gyro.rate_hz), gyro.vibration_degps
    )
    damped = math.exp(-2.0 * (math.pi * noise_degps / step_degps) ** 2)
    return step_degps / (math.pi * math.sqrt(2.0)) * damped


def wheel_wander_std(odometer: OdometerModel) -> float:
    """Of the sensor and the tyres together."""
    return math.hypot(odometer.scale_wander_std, TYRES_STD)


def start(gyro: GyroModel, odometer: OdometerModel) -> Floats:
    """Mean."""
    mean = np.zeros(len(S))
    mean[S.GYRO_BIAS], mean[S.GYRO_SCALE] = gyro.bias_degps, 1.0
    mean[S.WHEEL_SCALE] = 1.0 / (1.0 + odometer.scale)
    return mean


def start_stds(
    gps: GpsModel, gyro: GyroModel, odometer: OdometerModel, happened: Happenings
) -> Floats:
    """One sigma of each."""
    stds = np.zeros(len(S))
    stds[[S.EAST, S.NORTH]], stds[S.HEADING] = UNKNOWN_M, math.pi
    stds[S.GYRO_BIAS], stds[S.GYRO_WANDER] = gyro.bias_std_degps, gyro.bias_wander_std_degps
    stds[S.GYRO_ROUNDING] = rounding_std_degps(gyro)
    stds[S.GYRO_WARMTH], stds[S.GYRO_SCALE] = gyro.bias_per_kelvin_degps, gyro.scale_std
    stds[S.WHEEL_SCALE], stds[S.WHEEL_WANDER] = odometer.scale_std, wheel_wander_std(odometer)
    stds[S.WHEEL_SLIP] = happened.slip_std
    stds[[S.GPS_EAST, S.GPS_NORTH]] = gps.position_wander_std_m
    stds[[S.REFLECTED_EAST, S.REFLECTED_NORTH]] = math.sqrt(0.5)
    return stds
