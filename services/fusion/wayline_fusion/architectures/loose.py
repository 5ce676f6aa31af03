"""Pure: loose coupling (papers/001, 2 a): position, speed and course calibrate the sensors."""

import math
from typing import ClassVar

from wayline_fusion.architectures.architecture import Motion, Progress, SensorErrors
from wayline_fusion.architectures.estimator import Estimator
from wayline_fusion.filter.states import States

S = States


class Loose(Estimator):
    """The horizontal estimator as an architecture."""

    uses_vehicle: ClassVar[bool] = True

    def take_gyro(self, t_ns: int, rate_radps: float, rounding_std_radps: float) -> None:
        """Append to the measured turn, which predictions read."""
        self.gyro_rounding_radps = rounding_std_radps
        self.gyro.add(t_ns, rate_radps)

    @property
    def progress(self) -> Progress:
        """How far the vehicle has come."""
        return Progress(self.t_ns, self.distance_m, float(self.filter.x[S.WHEEL_SPEED]) < 0.0)

    def motion(self) -> Motion:
        """Where the vehicle is now."""
        memory, kalman = self.memory, self.filter
        place_deg = self.geodetic()
        moving = place_deg is not None or self.wheels_fresh
        return Motion(
            t_ns=self.t_ns,
            accepted_fix_ns=memory.accepted_fix_ns,
            place_deg=place_deg,
            east_std_m=kalman.std(S.EAST),
            north_std_m=kalman.std(S.NORTH),
            east_north_cov_m2=float(kalman.P[S.EAST, S.NORTH]),
            heading_deg=self.heading_deg() if memory.heading_known else None,
            heading_std_deg=math.degrees(kalman.std(S.HEADING)),
            speed_mps=kalman.speed_mps if moving else None,
            speed_std_mps=kalman.speed_std_mps,
            yaw_rate_degps=self._yaw_rate_degps(),
            is_unconfirmed=memory.position_unconfirmed,
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
