"""Pure: what is believed of one vehicle, and how a measurement changes it."""

import math

import msgspec

from wayline.geo import wrap_360
from wayline.messages import Verdict
from wayline.tuning import Tuning
from wayline_fusion.evidence.memory import Memory
from wayline_fusion.filter.gate import alarmed, judge, nis_of
from wayline_fusion.filter.gyro_track import GyroTrack
from wayline_fusion.filter.horizontal import DrivingNoise, HorizontalFilter
from wayline_fusion.filter.measurements import Measurement
from wayline_fusion.filter.states import States

WHEELS_FRESH_NS = 2_000_000_000
"""A wheel speed this old no longer says that the vehicle moves or stands."""
ROUNDING_CORRELATION_S = 0.1
"""While driving, the rate goes through a coarse gyro's steps this fast."""
SPEED_UNKNOWN_MPS = 40.0
"""Std of a speed that may be any."""
SCALE_UNKNOWN = 0.2
"""Of other tyres, or of a speed in a unit that was guessed."""


class Estimate:
    """Position, heading, speed and the errors of gyro and odometer, before any sensor's rules."""

    def __init__(self, tuning: Tuning) -> None:
        self.filter = HorizontalFilter(tuning)
        self.gyro = GyroTrack()
        self.gyro_rounding_radps = 0.0
        """Std of the gyro's steps."""
        self.t_ns = 0
        """What is believed is believed of this instant; 0 before the first event."""
        self.distance_m = 0.0
        """Travelled since the start."""
        self.memory = Memory()
        self.tuning = tuning
        self._turn_noise = math.radians(tuning.gyro_noise_deg_per_sqrt_s)
        self._bias_walk = math.radians(tuning.gyro_bias_walk_degps_per_sqrt_s)
        self.verdicts: list[Verdict] = []

    def take_verdicts(self) -> list[Verdict]:
        """Verdicts since the last call, those of events applied again after a rewind included."""
        verdicts, self.verdicts = self.verdicts, []
        return verdicts

    @property
    def standing(self) -> bool:
        """Whether the wheels have not turned for long enough."""
        since_ns = self.memory.still_since_ns
        if since_ns is None or not self.wheels_fresh:
            return False
        return self.t_ns - since_ns >= self.tuning.standstill_after_s * 1e9

    @property
    def wheels_fresh(self) -> bool:
        """Whether there is a recent wheel speed."""
        wheels_ns = self.memory.wheels_ns
        return wheels_ns is not None and self.t_ns - wheels_ns <= WHEELS_FRESH_NS

    @property
    def located(self) -> bool:
        """Whether position and heading are known."""
        return self.memory.plane is not None and self.memory.heading_known

    def geodetic(self) -> tuple[float, float] | None:
        """Latitude and longitude in degrees; None before the first fix."""
        if self.memory.plane is None:
            return None
        east_m, north_m = self.filter.x[States.EAST], self.filter.x[States.NORTH]
        return self.memory.plane.to_geodetic(float(east_m), float(north_m))

    def heading_deg(self) -> float:
        """Heading, true, clockwise from north."""
        return wrap_360(math.degrees(float(self.filter.x[States.HEADING])))

    def remember(self, **changes: object) -> None:
        """Replace some of the memory's fields."""
        self.memory = msgspec.structs.replace(self.memory, **changes)

    def driving_noise(self) -> DrivingNoise:
        """What is known of this gyro, learned or configured."""
        return DrivingNoise(
            math.hypot(
                self._turn_noise, self.gyro_rounding_radps * math.sqrt(ROUNDING_CORRELATION_S)
            ),
            self._bias_walk * self.memory.wander.multiple,
        )

    def gated(self, measurement: Measurement, t_ns: int, *, is_silent: bool = False) -> bool:
        """Correct with a likely measurement; `is_silent` says so only of an unlikely one."""
        expected = self.filter.expected(measurement)
        nis = nis_of(measurement, expected)
        verdict = judge(
            measurement.sensor, t_ns, nis, len(measurement.y), self.tuning.gate_probability
        )
        if not (is_silent and verdict.accepted):
            self.verdicts.append(alarmed(verdict, measurement, expected))
        if verdict.accepted:
            self.correct(measurement)
        return verdict.accepted

    def correct(self, measurement: Measurement) -> None:
        """Correct with a measurement of GPS; without wheels none of them tells of their scale."""
        if self.wheels_fresh:
            self.filter.correct(measurement)
        else:
            self.filter.consider(measurement, States.ODOMETER_SCALE)

    def tell(self, sensor: str, t_ns: int, reason: str) -> None:
        """Say that something known was given up."""
        self.verdicts.append(
            Verdict(sensor=sensor, t_ns=t_ns, accepted=False, nis=0.0, threshold=0.0, reason=reason)
        )
