"""Pure: the horizontal filter's state vector."""

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


class States:
    """Places in the state vector, with the unit of each.

    Plain numbers: indexing by an IntEnum takes numpy three times as long.
    """

    EAST = 0  # m
    NORTH = 1  # m
    HEADING = 2  # rad
    WHEEL_SPEED = 3  # m/s, negative in reverse; ODOMETER_SCALE times it is the speed
    GYRO_BIAS = 4  # rad/s
    GYRO_SCALE = 5
    ODOMETER_SCALE = 6
    GPS_EAST = 7  # slowly varying error of the fixes, in their own stds
    GPS_NORTH = 8
    LATENCY = 9  # s, of the fixes beyond what ingest has taken off
    ACCELERATION = 10  # m/s^2, along the heading
    COURSE_BIAS = 11  # rad, of the fixes' courses


SIZE = 12
"""Of the state vector."""
