"""Pure: what happens to the vehicle, one event for each thing that is to be taken in.

A fix is told part by part, so that each kind of measurement goes its own way: first the fix as a
whole, which brings the state to its instant, then its speed, course, position and altitude.
"""

import msgspec
import numpy as np
from numpy.typing import NDArray

from wayline.vertical.propulsion import Push

Floats = NDArray[np.float64]


class Elapsed(msgspec.Struct, frozen=True, gc=False):
    """Time has passed; keeps prediction steps short."""

    t_ns: int


class WheelSpeed(msgspec.Struct, frozen=True, gc=False):
    """Wheel speed as measured, negative in reverse, with the std of its rounding and noise."""

    t_ns: int
    speed_mps: float
    std_mps: float


class FixInterval(msgspec.Struct, frozen=True, gc=False):
    """A fix is about to be used, of a source that usually tells one in so many seconds."""

    t_ns: int
    usual_s: float


class Fix(msgspec.Struct, frozen=True, gc=False):
    """A valid fix as a whole; stds are one sigma of its total error, position per axis."""

    t_ns: int
    lat_deg: float
    lon_deg: float
    position_std_m: float
    speed_mps: float | None
    speed_std_mps: float
    own_speed_std_mps: float
    """Without what makes a bad fix count for less."""
    course_rad: float | None
    course_std_rad: float | None
    """None: from the speed's std."""
    is_good: bool = True
    """By satellites and PDOP (papers/003)."""
    speed_derived: bool = False
    """From positions, not by Doppler; the course too, unless it is told."""
    course_told: bool = True


class GpsSpeed(msgspec.Struct, frozen=True, gc=False):
    """Speed over ground of a fix, which has no sign."""

    t_ns: int
    speed_mps: float
    std_mps: float
    own_std_mps: float
    """By the fix's own dilution: a bad one's `std_mps` all but ignores it (papers/003)."""


class GpsCourse(msgspec.Struct, frozen=True, gc=False):
    """Course over ground of a fix, with the speed that it was measured at where that is told."""

    t_ns: int
    course_rad: float
    std_rad: float | None
    """None: from the speed's std."""
    speed_mps: float | None
    speed_std_mps: float
    own_speed_std_mps: float


class GyroCheck(msgspec.Struct, frozen=True, gc=False):
    """A course has been taken in, and can be held against the turn that the gyro has measured."""

    t_ns: int


class VelocityTold(msgspec.Struct, frozen=True, gc=False):
    """Speed and course of a fix have been taken in, and its position comes next."""

    t_ns: int


class GpsPosition(msgspec.Struct, frozen=True, gc=False):
    """Position of a fix; the std is one sigma of its total error per axis."""

    t_ns: int
    lat_deg: float
    lon_deg: float
    std_m: float
    is_good: bool = True


class FixSeen(msgspec.Struct, frozen=True, gc=False):
    """A position, believed or not, that lies somewhere along the reckoned way."""

    t_ns: int
    lat_deg: float
    lon_deg: float
    std_m: float
    tells_speed: bool


class FixTaken(msgspec.Struct, frozen=True, gc=False):
    """A position has been tried, and can be held against those before."""

    t_ns: int
    lat_deg: float
    lon_deg: float
    std_m: float
    tells_speed: bool


class Ranges(msgspec.Struct, frozen=True, gc=False):
    """One epoch of raw measurements, a row for each satellite; nan is what is not told."""

    t_ns: int
    names: tuple[str, ...]
    """As verdicts call them."""
    systems: tuple[str, ...]
    places_m: Floats
    """Earth-centred, Earth-fixed, in the frame of the transmission; shape (n, 3)."""
    pseudoranges_m: Floats
    """Free of the satellites' clocks and of the atmosphere."""
    stds_m: Floats
    """As the receiver claims them."""
    cn0_dbhz: Floats
    motions_mps: Floats
    """Shape (n, 3)."""
    rates_mps: Floats
    """Of the ranges, positive going away, free of the satellites' clocks."""
    rate_stds_mps: Floats


class GpsAltitude(msgspec.Struct, frozen=True, gc=False):
    """Altitude above mean sea level of a fix, with one sigma of its total error."""

    t_ns: int
    alt_m: float
    std_m: float
    source: str
    """The receiver: each has its own error."""


class Pressure(msgspec.Struct, frozen=True, gc=False):
    """Altitude at which the standard atmosphere has the measured pressure."""

    t_ns: int
    alt_m: float
    std_m: float
    """Of rounding and noise; the weather is the barometer's bias."""


class ReportedSlope(msgspec.Struct, frozen=True, gc=False):
    """The slope (tan of the angle) that the vehicle reports, a mean that ends at the instant."""

    t_ns: int
    length_s: float
    slope: float


class GyroRestarted(msgspec.Struct, frozen=True, gc=False):
    """The gyro, whose calibration was kept, is now so much warmer (or colder) than it was then."""

    t_ns: int
    warmer_c: float


class GyroWarmed(msgspec.Struct, frozen=True, gc=False):
    """Under way the gyro has become so much warmer, or colder."""

    t_ns: int
    warmer_c: float


class ClockStep(msgspec.Struct, frozen=True, gc=False):
    """All sensors' time has jumped: the vehicle drove for so much less or more than it says."""

    t_ns: int
    step_s: float


Event = (
    Elapsed
    | WheelSpeed
    | FixInterval
    | Fix
    | GpsSpeed
    | GpsCourse
    | GyroCheck
    | VelocityTold
    | GpsPosition
    | FixSeen
    | FixTaken
    | Ranges
    | GpsAltitude
    | Pressure
    | Push
    | ReportedSlope
    | GyroRestarted
    | GyroWarmed
    | ClockStep
)


def parts_of(fix: Fix) -> tuple[Event, ...]:
    """A fix and its parts in the order in which they are used.

    Speed and course come first: walls that displace a position by metres leave Doppler alone. A
    course without a speed comes last: where the fixes have moved tells whether it means anything.
    """
    t_ns, std_m = fix.t_ns, fix.position_std_m
    tells_speed = fix.speed_mps is not None and not fix.speed_derived
    place: tuple[Event, ...] = (
        GpsPosition(t_ns, fix.lat_deg, fix.lon_deg, std_m, fix.is_good),
        FixSeen(t_ns, fix.lat_deg, fix.lon_deg, std_m, tells_speed),
        FixTaken(t_ns, fix.lat_deg, fix.lon_deg, std_m, tells_speed),
    )
    if fix.speed_mps is None or not tells_speed:
        return (fix, *place, *_course(fix, None))
    speed = GpsSpeed(t_ns, fix.speed_mps, fix.speed_std_mps, fix.own_speed_std_mps)
    return (fix, speed, *_course(fix, fix.speed_mps), VelocityTold(t_ns), *place)


def _course(fix: Fix, speed_mps: float | None) -> tuple[Event, ...]:
    if fix.course_rad is None or not fix.course_told:
        return ()
    stds_mps = fix.speed_std_mps, fix.own_speed_std_mps
    course = GpsCourse(fix.t_ns, fix.course_rad, fix.course_std_rad, speed_mps, *stds_mps)
    return course, GyroCheck(fix.t_ns)
