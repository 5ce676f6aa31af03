"""Pure: what happens to the vehicle, as the horizontal estimator takes it in."""

import msgspec


class Step(msgspec.Struct, frozen=True, gc=False):
    """Time passes; keeps prediction steps short."""

    t_ns: int


class WheelSpeed(msgspec.Struct, frozen=True, gc=False):
    """Wheel speed as measured, negative in reverse, with the std of its rounding and noise."""

    t_ns: int
    speed_mps: float
    std_mps: float


class Fix(msgspec.Struct, frozen=True, gc=False):
    """A valid fix; stds are one sigma of its total error, position per axis."""

    t_ns: int
    lat_deg: float
    lon_deg: float
    position_std_m: float
    speed_mps: float | None
    speed_std_mps: float
    course_rad: float | None
    course_std_rad: float | None
    """None: from the speed's std."""
    is_good: bool = True
    """By satellites and PDOP (papers/003)."""
    speed_derived: bool = False
    """From positions, not by Doppler."""


class GyroRestarted(msgspec.Struct, frozen=True, gc=False):
    """The gyro, whose calibration was kept, is now so much warmer (or colder) than it was then."""

    t_ns: int
    warmer_c: float


class ClockStep(msgspec.Struct, frozen=True, gc=False):
    """All sensors' time has jumped: the vehicle drove for so much less or more than it says."""

    t_ns: int
    step_s: float


Event = Step | WheelSpeed | Fix | GyroRestarted | ClockStep
