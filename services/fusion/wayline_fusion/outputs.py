"""Pure: poses and statuses, from what is believed of the vehicle."""

import math
from typing import NamedTuple

import msgspec

from wayline.messages import Calibration, FusionStatus, Pose, PoseMode
from wayline.satellites.doppler import AntennaMotion
from wayline.tuning import Tuning
from wayline_fusion.architectures.architecture import Architecture, Motion, SensorErrors
from wayline_fusion.evidence.slopes_told import SlopesTold
from wayline_fusion.filter.vertical import VerticalEstimate
from wayline_fusion.intake.told import Told

UNKNOWN_ALT_STD_M = 500.0
UNKNOWN_GRADE_STD_PCT = 4.0
"""Roads are rarely steeper than twice this."""
OUTAGE_S = 2.0
OUTAGE_INTERVALS = 1.5
"""Without an accepted fix for the longer of these the pose is dead reckoning (SPEC section 2)..."""
LOST_STD_M = 100.0
LOST_S = 90.0
LOST_INTERVALS = 3.0
"""...and for the longer of these, and with a std as large, it is lost."""


class Fixes(NamedTuple):
    """How they come."""

    usual_s: float
    """Between two of them."""
    delay_ns: int
    """Later than they describe."""


class Outputs:
    """Words what the estimates know as messages."""

    def __init__(
        self,
        estimator: Architecture,
        vertical: VerticalEstimate,
        told: Told,
        slopes: SlopesTold,
        tuning: Tuning,
        *,
        mass_kg: float,
    ) -> None:
        self._estimator, self._vertical = estimator, vertical
        self._told, self._slopes, self._tuning = told, slopes, tuning
        self._mass_kg = mass_kg
        self._distance_m = 0.0

    def pose(self, t_ns: int, fixes: Fixes, *, has_can: bool) -> Pose:
        """Of the state as it is, for an instant."""
        progress = self._estimator.progress
        motion, height = self._estimator.motion(), self._vertical.height_at(progress)
        self._distance_m = max(self._distance_m, progress.distance_m)
        place, is_directed = motion.place_deg, motion.heading_deg is not None
        return Pose(
            t_ns=t_ns,
            mode=_mode(motion, fixes, has_can=has_can),
            lat_deg=place[0] if place else None,
            lon_deg=place[1] if place else None,
            alt_m=height.alt_m if height else None,
            heading_deg=motion.heading_deg,
            speed_mps=motion.speed_mps,
            yaw_rate_degps=motion.yaw_rate_degps,
            grade_pct=height.grade_pct if height else None,
            distance_m=self._distance_m,
            east_std_m=motion.east_std_m if place else None,
            north_std_m=motion.north_std_m if place else None,
            east_north_cov_m2=motion.east_north_cov_m2 if place else None,
            heading_std_deg=motion.heading_std_deg if is_directed else None,
            speed_std_mps=None if motion.speed_mps is None else motion.speed_std_mps,
            alt_std_m=height.alt_std_m if height else None,
            grade_std_pct=height.grade_std_pct if height else None,
        )

    def carried(self) -> AntennaMotion | None:
        """How a receiver's antenna moves; None while place, heading or speed are unknown.

        Its height is above mean sea level; where none is known it is 0, and as unsure.
        """
        motion, height = (
            self._estimator.motion(),
            self._vertical.height_at(self._estimator.progress),
        )
        if motion.place_deg is None or motion.heading_deg is None or motion.speed_mps is None:
            return None
        east_m2, north_m2 = motion.east_std_m**2, motion.north_std_m**2
        alt_m = height.alt_m if height and height.alt_m is not None else 0.0
        alt_std_m = (
            height.alt_std_m if height and height.alt_std_m is not None else UNKNOWN_ALT_STD_M
        )
        return AntennaMotion(
            *motion.place_deg,
            height_m=alt_m,
            heading_deg=motion.heading_deg,
            speed_mps=motion.speed_mps,
            grade_pct=height.grade_pct if height else 0.0,
            place_std_m=math.sqrt(max(east_m2, north_m2) + alt_std_m**2),
            heading_std_deg=motion.heading_std_deg,
            speed_std_mps=motion.speed_std_mps,
            grade_std_pct=height.grade_std_pct if height else UNKNOWN_GRADE_STD_PCT,
        )

    def status(self, t_ns: int) -> FusionStatus:
        """What is known of the sensors, and the verdicts since the last one."""
        errors, motion = self._estimator.sensor_errors(), self._estimator.motion()
        accepted_ns = motion.accepted_fix_ns
        bias_m, bias_std_m = self._vertical.baro_bias()
        torque = self._vertical.torque_errors()
        return FusionStatus(
            t_ns=t_ns,
            **msgspec.structs.asdict(errors),
            baro_bias_m=bias_m,
            baro_bias_std_m=bias_std_m,
            torque_bias_pct=100.0 * torque.bias if torque else None,
            torque_bias_std_pct=100.0 * torque.bias_std if torque else None,
            mass_kg=torque.mass * self._mass_kg if torque else None,
            mass_std_kg=torque.mass_std * self._mass_kg if torque else None,
            calibration=_calibration(errors, self._tuning, is_located=_is_located(motion)),
            outage_s=0.0 if accepted_ns is None else max(t_ns - accepted_ns, 0) * 1e-9,
            late=self._told.late,
            rejected=self._told.rejected,
            verdicts=self._told.take(),
            slopes=tuple(self._slopes.told(torque)),
        )


def _mode(motion: Motion, fixes: Fixes, *, has_can: bool) -> PoseMode:
    """A fix that is on its way is not missing."""
    if not _is_located(motion) or motion.accepted_fix_ns is None:
        return "starting"
    without_s = (motion.t_ns - fixes.delay_ns - motion.accepted_fix_ns) * 1e-9
    std_m = max(motion.east_std_m, motion.north_std_m)
    if std_m > LOST_STD_M and without_s > max(LOST_S, LOST_INTERVALS * fixes.usual_s):
        return "lost"
    if motion.is_unconfirmed or without_s > max(OUTAGE_S, OUTAGE_INTERVALS * fixes.usual_s):
        return "dead_reckoning"
    return "fused" if has_can else "gps"


def _calibration(errors: SensorErrors, tuning: Tuning, *, is_located: bool) -> Calibration:
    bias_std_degps, scale_std = errors.gyro_bias_std_degps, errors.odometer_scale_std
    if (
        bias_std_degps is not None
        and scale_std is not None
        and bias_std_degps <= tuning.calibrated_bias_std_degps
        and scale_std <= tuning.calibrated_scale_std
    ):
        return "calibrated"
    return "started" if is_located else "none"


def _is_located(motion: Motion) -> bool:
    """Whether position and heading are known."""
    return motion.place_deg is not None and motion.heading_deg is not None
