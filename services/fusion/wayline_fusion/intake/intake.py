"""Pure: readings of one vehicle, held against what can be and made into events."""

import math
from typing import Protocol

from wayline.air import metres_per_pascal, pressure_altitude_m
from wayline.cadence import Cadence
from wayline.drive import Vehicle
from wayline.gps_quality import altitude_std_m, has_altitude, horizontal_std_m, is_good
from wayline.messages import Barometer, GpsFix, GpsRaw, Gyro, Message, Odometer, Torque
from wayline.resolution import PRESSURE_UNIT_PA, Resolution
from wayline.tuning import Tuning
from wayline.vertical.engine import Engine
from wayline.vertical.propulsion import Push
from wayline_fusion.filter.gyro_track import TakeGyro
from wayline_fusion.intake.clock_steps import ClockSteps
from wayline_fusion.intake.events import (
    ClockStep,
    Event,
    Fix,
    FixInterval,
    GpsAltitude,
    GyroWarmed,
    Pressure,
    ReportedSlope,
    WheelSpeed,
    parts_of,
)
from wayline_fusion.intake.fix_velocity import FixVelocity
from wayline_fusion.intake.plausibility import Plausibility, within_reason
from wayline_fusion.intake.ranges import ranges_of
from wayline_fusion.intake.told import Told
from wayline_fusion.intake.warmth import Warmth

SENSORS: dict[type[Message], str] = {
    Barometer: "barometer",
    GpsFix: "gps_position",
    GpsRaw: "gps_raw",
    Gyro: "gyro",
    Odometer: "odometer",
    Torque: "torque",
}
"""Under which name a refusal is told."""
KMH_MPS = 1.0 / 3.6
DILUTION_MIN = 0.6
GYRO_ROUNDING_MAX_DEGPS = 0.15
"""Of steps of half a degree a second; until enough is read, steps seem larger."""


class Gyroscoped(Protocol):
    """What the gyro is for."""

    @property
    def take_gyro(self) -> TakeGyro:
        """Takes an instant and a rate in rad/s, clockwise."""
        ...

    def know_gyro_steps(self, rounding_std_radps: float) -> None:
        """Take the std of the gyro's steps."""
        ...


class Intake:
    """Knows the sensors' steps and what the last readings were; refusals are told to `told`."""

    def __init__(self, tuning: Tuning, told: Told, estimator: Gyroscoped, vehicle: Vehicle) -> None:
        self._tuning, self._told = tuning, told
        self._estimator, self._take_gyro = estimator, estimator.take_gyro
        self.vehicle_ns: int | None = None
        """Of the newest reading of gyro or wheels."""
        self.fix_ns: int | None = None
        """Of the newest valid fix."""
        self.cadence = Cadence()
        """Of the valid fixes, whichever receiver they come from."""
        self._clock_steps = ClockSteps()
        self.step_of_clock_s = self._clock_steps.step_s
        """How far the clock has stepped before a message; asked of every message, and first."""
        self.refusal = Plausibility().refusal
        """Why a reading cannot be; asked of every message of a source."""
        self._velocity = FixVelocity()
        self._wheel_steps = Resolution(1e-4)
        self._rate_steps = Resolution(1e-4)
        self._pressure_steps = Resolution(PRESSURE_UNIT_PA)
        self._warmth = Warmth()
        self._engine = Engine(vehicle, tuning)
        self._reverse = False

    @property
    def heard_ns(self) -> int | None:
        """When a sensor said something for the last time."""
        return max(self.vehicle_ns or 0, self.fix_ns or 0) or None

    def clock_step(self, step_s: float) -> ClockStep:
        """The event of a step that `step_of_clock_s` has found."""
        return ClockStep(self._clock_steps.newest_ns, step_s)

    def refuse(self, message: Message, reason: str) -> None:
        """Tell of a reading that `refusal` has found to be none."""
        sensor, now_ns = SENSORS[type(message)], self._clock_steps.newest_ns
        self._told.refuse(sensor, message.t_ns, reason, now_ns)

    def gyro(self, gyro: Gyro) -> None:
        """Pass a measured rate on, and the std of the gyro's steps; it is no event of its own."""
        rate_degps = gyro.yaw_rate_degps
        if rate_degps is None:
            return
        self.vehicle_ns = gyro.t_ns
        steps = self._rate_steps
        if not steps.settled and steps.learn(rate_degps):
            rounding_degps = min(steps.std, GYRO_ROUNDING_MAX_DEGPS)
            self._estimator.know_gyro_steps(math.radians(rounding_degps))
        self._take_gyro(gyro.t_ns, math.radians(rate_degps))

    def warmed(self, gyro: Gyro) -> GyroWarmed | None:
        """What a gyro's message tells of its warmth."""
        return self._warmth.change(gyro)

    def wheel_speed(self, odometer: Odometer) -> WheelSpeed | None:
        """What an odometer's message tells of the speed."""
        if odometer.reverse is not None:
            self._reverse = odometer.reverse
        if odometer.speed_mps is None:
            return None
        self.vehicle_ns = odometer.t_ns
        self._wheel_steps.learn(odometer.speed_mps)
        rounding_mps = min(self._wheel_steps.std, KMH_MPS)
        std_mps = math.hypot(rounding_mps, self._tuning.odometer_std_mps)
        signed_mps = -odometer.speed_mps if self._reverse else odometer.speed_mps
        return WheelSpeed(odometer.t_ns, signed_mps, std_mps)

    def push(self, odometer: Odometer) -> Push | None:
        """What torque has told of the slope up to an odometer's message."""
        return self._engine.wheels(odometer)

    def torque(self, torque: Torque) -> ReportedSlope | None:
        """What a torque's message tells of the slope by itself."""
        slope = self._engine.torque(torque)
        return None if slope is None else ReportedSlope(*slope)

    def pressure(self, barometer: Barometer) -> Pressure | None:
        """What a barometer's message tells of the altitude; a coarse one says nothing of it."""
        pressure_pa, tuning = barometer.pressure_pa, self._tuning
        if pressure_pa is None or "barometer" not in tuning.vertical_sensors:
            return None
        self._pressure_steps.learn(pressure_pa)
        rounding_m = self._pressure_steps.std * metres_per_pascal(pressure_pa)
        if rounding_m > tuning.baro_resolution_std_max_m:
            return None
        std_m = math.hypot(rounding_m, tuning.baro_std_m)
        return Pressure(barometer.t_ns, pressure_altitude_m(pressure_pa), std_m)

    def fix(self, fix: GpsFix, source: str) -> tuple[Event, ...]:
        """A fix and its parts, in the order in which they are used; nothing of an invalid one."""
        fix = within_reason(fix)
        if not fix.valid or fix.lat_deg is None or fix.lon_deg is None:
            return ()
        self.fix_ns = fix.t_ns
        self.cadence = self.cadence.noticed(fix.t_ns)
        interval = FixInterval(fix.t_ns, self.cadence.usual_s)
        parts = interval, *parts_of(self._with_velocity(fix, fix.lat_deg, fix.lon_deg))
        altitude = self._altitude(fix, source)
        return parts if altitude is None else (*parts, altitude)

    def ranges(self, epoch: GpsRaw) -> tuple[Event, ...]:
        """An epoch of raw measurements; nothing of one that no satellite can be used of."""
        ranges = ranges_of(epoch)
        if ranges is None:
            return ()
        self.fix_ns = epoch.t_ns
        return (ranges,)

    def _altitude(self, fix: GpsFix, source: str) -> GpsAltitude | None:
        if fix.alt_m is None or not has_altitude(fix):
            return None
        if "gps" not in self._tuning.vertical_sensors:
            return None
        return GpsAltitude(fix.t_ns, fix.alt_m, altitude_std_m(fix, self._tuning), source)

    def _with_velocity(self, fix: GpsFix, lat_deg: float, lon_deg: float) -> Fix:
        position_std_m = horizontal_std_m(fix, self._tuning)
        # a speed derived from the positions is no second measurement beside them
        speed_mps = None if fix.speed_derived else fix.speed_mps
        speed_std_mps = fix.speed_std_mps
        course_deg, course_std_deg = fix.course_deg, fix.course_std_deg
        if speed_mps is None and (mean := self._velocity.mean(fix, position_std_m)):
            speed_mps, speed_std_mps = mean.speed_mps, mean.speed_std_mps
            if course_deg is None:
                course_deg, course_std_deg = mean.course_deg, mean.course_std_deg
        good, own_std_mps = is_good(fix, self._tuning), doppler_std_mps(fix, self._tuning)
        return Fix(
            fix.t_ns,
            lat_deg,
            lon_deg,
            position_std_m,
            speed_mps,
            speed_std_mps or own_std_mps * (1.0 if good else self._tuning.bad_gps_factor),
            speed_std_mps or own_std_mps,
            None if course_deg is None else math.radians(course_deg),
            None if course_std_deg is None else math.radians(course_std_deg),
            is_good=good,
            speed_derived=fix.speed_derived or fix.speed_mps is None,
            course_told=fix.course_deg is not None,
        )


def doppler_std_mps(fix: GpsFix, tuning: Tuning) -> float:
    """Of a fix that tells none: Doppler suffers from dilution as positions do."""
    dilution = max(fix.hdop, DILUTION_MIN) if fix.hdop is not None else 1.0
    return tuning.gps_speed_std_mps * dilution
