"""Pure: places in space seen from an earth that turns."""

import math
from typing import NamedTuple

SPEED_OF_LIGHT_MPS = 299_792_458.0
EARTH_RATE_RADPS = 7.2921151467e-5
"""IS-GPS-200, table 20-IV: the earth's turn."""
EARTH_MU_M3PS2 = 3.986004418e14
"""WGS84's gravitational constant of the earth."""


class Vector(NamedTuple):
    """A place in m, a motion in m/s or an acceleration in m/s2, earth-fixed (ECEF)."""

    x: float
    y: float
    z: float

    def moved(self, by: "Vector", times: float = 1.0) -> "Vector":
        """The sum with another one, taken so many times."""
        return Vector(self.x + times * by.x, self.y + times * by.y, self.z + times * by.z)

    @property
    def length(self) -> float:
        """In the vector's own unit."""
        return math.hypot(*self)


def turned(place_m: Vector, flight_s: float) -> Vector:
    """A place of an instant in the earth-fixed frame that holds `flight_s` later.

    What a satellite's place has to undergo between the transmission and the reception of its
    signal (Sagnac); with a negative time it is undone.
    """
    angle_rad = EARTH_RATE_RADPS * flight_s
    cos, sin = math.cos(angle_rad), math.sin(angle_rad)
    return Vector(cos * place_m.x + sin * place_m.y, cos * place_m.y - sin * place_m.x, place_m.z)


def acceleration_mps2(place_m: Vector, motion_mps: Vector) -> Vector:
    """How a satellite's earth-fixed motion changes: the earth's pull, Coriolis, centrifugal force.

    The earth is a point here: its flattening adds 5e-5 m/s2 at the height of such satellites.
    """
    pull = -EARTH_MU_M3PS2 / place_m.length**3
    rate = EARTH_RATE_RADPS
    return Vector(
        pull * place_m.x + 2.0 * rate * motion_mps.y + rate * rate * place_m.x,
        pull * place_m.y - 2.0 * rate * motion_mps.x + rate * rate * place_m.y,
        pull * place_m.z,
    )
