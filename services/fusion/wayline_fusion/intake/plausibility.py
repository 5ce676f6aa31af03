"""Pure: readings that no vehicle can cause, refused before a filter sees them."""

import math

import msgspec

from wayline.messages import Barometer, GpsFix, Gyro, Odometer, Torque
from wayline.vertical.frozen_torque import FROZEN, FrozenTorque
from wayline.vertical.plausible import NO_SUCH_AIR, is_air, is_on_earth
from wayline_fusion.intake.frozen_receiver import FrozenReceiver

FASTEST_MPS = 150.0
"""Faster than any road vehicle, slower than a reading in wrong units or with torn bits."""
HARDEST_TURN_MPS2 = 15.0
"""Tyres hold 10 m/s2; a gyro's spike at speed claims more."""
FASTEST_TURN_DEGPS = 360.0
"""At any speed."""
STDS_M = (1e-3, 1e4)
SPEED_STDS_MPS = (1e-2, 1e2)
COURSE_STDS_DEG = (1e-2, 180.0)
DILUTION_MAX = 100.0
"""Receivers write 99.9 for none."""
SPEED_HELD_NS = 1_000_000_000
"""A speed is held this long (SPEC section 2)."""


def within_reason(fix: GpsFix) -> GpsFix:
    """A fix whose stds are neither certainty nor beyond all use, without an altitude in space."""
    return msgspec.structs.replace(
        fix,
        alt_m=fix.alt_m if fix.alt_m is not None and is_on_earth(fix.alt_m) else None,
        h_std_m=_within(STDS_M, fix.h_std_m),
        v_std_m=_within(STDS_M, fix.v_std_m),
        speed_std_mps=_within(SPEED_STDS_MPS, fix.speed_std_mps),
        course_std_deg=_within(COURSE_STDS_DEG, fix.course_std_deg),
        hdop=_within((0.0, DILUTION_MAX), fix.hdop),
        pdop=_within((0.0, DILUTION_MAX), fix.pdop),
        vdop=_within((0.0, DILUTION_MAX), fix.vdop),
    )


def _within(bounds: tuple[float, float], value: float | None) -> float | None:
    return None if value is None else min(max(value, bounds[0]), bounds[1])


def _slow_turn_degps(speed_mps: float) -> float:
    """The fastest turn that is possible at a speed."""
    if speed_mps <= 0.0:
        return FASTEST_TURN_DEGPS
    return min(math.degrees(HARDEST_TURN_MPS2 / speed_mps), FASTEST_TURN_DEGPS)


class Plausibility:
    """Holds each reading of one vehicle against what its wheels say."""

    def __init__(self) -> None:
        self._wheels: Odometer | None = None
        self._receivers: dict[str, FrozenReceiver] = {}
        self._torque = FrozenTorque()
        self._driven_m = 0.0
        self._slow_turn_degps = FASTEST_TURN_DEGPS
        """Turns as slow as this are possible at the last speed, however old it is."""

    def refusal(self, message: msgspec.Struct, source: str) -> str | None:
        """Why a message is not to be used; None for a plausible one."""
        if type(message) is Gyro:
            rate_degps = message.yaw_rate_degps
            slow_degps = self._slow_turn_degps
            if rate_degps is None or -slow_degps <= rate_degps <= slow_degps:
                return None
            return self._of_turn(message.t_ns, rate_degps)
        if isinstance(message, Odometer):
            return self._of_wheels(message)
        if isinstance(message, GpsFix) and message.valid:
            return self._of_fix(message, source)
        if isinstance(message, Barometer | Torque):
            return self._of_height(message)
        return None

    def _of_height(self, message: Barometer | Torque) -> str | None:
        if isinstance(message, Barometer):
            is_none = message.pressure_pa is not None and not is_air(message.pressure_pa)
            return NO_SUCH_AIR if is_none else None
        if self._torque.is_frozen(message, self._driven_m):
            return FROZEN
        return None

    def _of_turn(self, t_ns: int, rate_degps: float) -> str | None:
        if abs(rate_degps) > FASTEST_TURN_DEGPS:
            return "no vehicle turns so fast"
        sideways_mps2 = math.radians(abs(rate_degps)) * self._speed_mps(t_ns)
        return (
            "no vehicle turns so fast at its speed" if sideways_mps2 > HARDEST_TURN_MPS2 else None
        )

    def _of_wheels(self, wheels: Odometer) -> str | None:
        if wheels.speed_mps is None:
            return None
        if wheels.speed_mps > FASTEST_MPS:
            return "no vehicle is so fast"
        before = self._wheels
        if before is not None and 0 < wheels.t_ns - before.t_ns <= SPEED_HELD_NS:
            self._driven_m += wheels.speed_mps * (wheels.t_ns - before.t_ns) * 1e-9
        self._wheels = wheels
        self._slow_turn_degps = _slow_turn_degps(wheels.speed_mps)
        return None

    def _of_fix(self, fix: GpsFix, source: str) -> str | None:
        if (fix.speed_mps or 0.0) > FASTEST_MPS:
            return "no vehicle is so fast"
        receiver = self._receivers.setdefault(source, FrozenReceiver())
        has_wheels = self._wheels is not None and fix.t_ns - self._wheels.t_ns <= SPEED_HELD_NS
        if receiver.is_frozen(fix, self._driven_m if has_wheels else None):
            return "the receiver repeats a position that the vehicle has left"
        return None

    def _speed_mps(self, t_ns: int) -> float:
        wheels = self._wheels
        if wheels is None or wheels.speed_mps is None or t_ns - wheels.t_ns > SPEED_HELD_NS:
            return 0.0
        return wheels.speed_mps
