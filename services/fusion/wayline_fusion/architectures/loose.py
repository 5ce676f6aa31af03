"""Pure: loose coupling (papers/001, 2 a): position, speed and course calibrate the sensors."""

import math
from collections.abc import Mapping
from typing import ClassVar

from wayline.tuning import Tuning
from wayline_fusion.aids.alignment import Alignment
from wayline_fusion.aids.bridge import Bridge
from wayline_fusion.aids.clock_jump import ClockJump
from wayline_fusion.aids.course import Course
from wayline_fusion.aids.displacement import Displacement
from wayline_fusion.aids.gyro_restart import GyroRestart
from wayline_fusion.aids.gyro_wander import GyroWander
from wayline_fusion.aids.gyro_warmth import GyroWarmth
from wayline_fusion.aids.kept_pose import KeptPose
from wayline_fusion.aids.long_way import LongWay
from wayline_fusion.aids.manoeuvre import allow_manoeuvre
from wayline_fusion.aids.position import Position
from wayline_fusion.aids.rest import Rest
from wayline_fusion.aids.speed import Speed
from wayline_fusion.aids.unseen import allow_turn, allow_unseen
from wayline_fusion.aids.wheels import Wheels
from wayline_fusion.architectures.architecture import Motion, SensorErrors
from wayline_fusion.filter.estimate import Aid, Estimate
from wayline_fusion.filter.gyro_track import TakeGyro
from wayline_fusion.filter.horizontal import HorizontalFilter
from wayline_fusion.filter.states import States
from wayline_fusion.filter.vertical import Progress
from wayline_fusion.intake.events import (
    ClockStep,
    Elapsed,
    Event,
    Fix,
    FixInterval,
    FixSeen,
    FixTaken,
    GpsCourse,
    GpsPosition,
    GpsSpeed,
    GyroCheck,
    GyroRestarted,
    GyroWarmed,
    VelocityTold,
    WheelSpeed,
)

S = States


class Loose(Estimate):
    """The horizontal estimate with all aids, as an architecture."""

    uses_vehicle: ClassVar[bool] = True

    def __init__(
        self,
        tuning: Tuning,
        aid_of: Mapping[type[Event], Aid] | None = None,
        kalman: HorizontalFilter | None = None,
    ) -> None:
        super().__init__(tuning, aid_of or aids(), kalman)
        self.take_gyro: TakeGyro = self.gyro.add
        """Appends to the measured turn, which predictions read."""

    def know_gyro_steps(self, rounding_std_radps: float) -> None:
        """Count the gyro's steps as noise."""
        self.gyro_rounding_radps = rounding_std_radps

    @property
    def progress(self) -> Progress:
        """How far the vehicle has come."""
        return Progress(self.t_ns, self.distance_m, self.filter.speed_mps)

    def motion(self) -> Motion:
        """Where the vehicle is now."""
        situation, kalman = self.situation, self.filter
        place_deg = self.geodetic()
        moving = place_deg is not None or self.wheels_fresh
        return Motion(
            t_ns=self.t_ns,
            accepted_fix_ns=situation.accepted_fix_ns,
            place_deg=place_deg,
            east_std_m=kalman.std(S.EAST),
            north_std_m=kalman.std(S.NORTH),
            east_north_cov_m2=float(kalman.P[S.EAST, S.NORTH]),
            heading_deg=self.heading_deg() if situation.heading_known else None,
            heading_std_deg=math.degrees(kalman.std(S.HEADING)),
            speed_mps=kalman.speed_mps if moving else None,
            speed_std_mps=kalman.speed_std_mps,
            yaw_rate_degps=self._yaw_rate_degps(),
            is_unconfirmed=situation.position_unconfirmed,
        )

    def _yaw_rate_degps(self) -> float | None:
        rate_radps, x = self.gyro.rate_radps(self.t_ns), self.filter.x
        if rate_radps is None:
            return None
        return math.degrees(float(x[S.GYRO_SCALE]) * (rate_radps - float(x[S.GYRO_BIAS])))

    def sensor_errors(self) -> SensorErrors:
        """What has been learned of the sensors."""
        kalman = self.filter
        return SensorErrors(
            gyro_bias_degps=math.degrees(float(kalman.x[S.GYRO_BIAS])),
            gyro_bias_std_degps=math.degrees(kalman.std(S.GYRO_BIAS)),
            gyro_scale=float(kalman.x[S.GYRO_SCALE]),
            gyro_scale_std=kalman.std(S.GYRO_SCALE),
            odometer_scale=float(kalman.x[S.ODOMETER_SCALE]),
            odometer_scale_std=kalman.std(S.ODOMETER_SCALE),
            gps_latency_s=float(kalman.x[S.LATENCY]),
            gps_latency_std_s=kalman.std(S.LATENCY),
        )


def aids() -> Mapping[type[Event], Aid]:
    """Fresh ones, by the event that each takes."""
    return {
        FixInterval: LongWay(),
        Fix: KeptPose(),
        GpsSpeed: Speed(allow_manoeuvre),
        GpsCourse: Course(allow_turn),
        GyroCheck: GyroWander(),
        VelocityTold: Bridge(),
        GpsPosition: Position(allow_unseen),
        FixSeen: Alignment(),
        FixTaken: Displacement(),
        WheelSpeed: Wheels(allow_manoeuvre),
        Elapsed: Rest(),
        GyroRestarted: GyroRestart(),
        GyroWarmed: GyroWarmth(),
        ClockStep: ClockJump(),
    }
