"""Pure: from the estimator's state to what is kept of it, and what is still good of that later.

Switched off, a gyro's bias goes on wandering and has another value when it is switched on; a
vehicle stays where it was parked unless somebody moved it, and goes on where it was driving.
"""

import math

import msgspec
import numpy as np

from wayline.geo import LocalPlane, wrap_360, wrap_pi
from wayline.noise_scale import NoiseScale
from wayline.tuning import Tuning
from wayline_fusion.evidence.bias_wander import BiasWander
from wayline_fusion.evidence.learned import Learned
from wayline_fusion.filter.estimate import Snapshot
from wayline_fusion.filter.situation import Situation
from wayline_fusion.filter.states import Floats, States
from wayline_fusion.keeping.records import LastPose, Saved, SensorCalibration

S = States
CALIBRATED = (S.GYRO_BIAS, S.GYRO_SCALE, S.ODOMETER_SCALE, S.LATENCY)
PLACED = (S.EAST, S.NORTH, S.HEADING, S.WHEEL_SPEED)
UPPER = np.triu_indices(len(CALIBRATED), 1)
SCALES_SETTLE_S = 7_200.0
"""Tyres and gyro are cold after two hours; from then on their scales stay."""
CLOCK_SLACK_S = 1.0
"""Messages come out of order by so much; further back is not after the pose was kept."""
STOOD_MPS = 0.5
"""Slower is standing."""
ACCELERATION_MPS2 = 1.5
"""What the speed may have changed by while nobody looked."""
LATERAL_MPS2 = 1.0
"""What the heading may have turned by meanwhile: curves are driven at so much sideways."""
USEFUL_STD_M, USEFUL_STD_DEG = 100.0, 30.0
"""A place or heading known worse is none to go on from."""


def kept(snapshot: Snapshot, t_ns: int, gyro_temperature_c: float | None) -> Saved | None:
    """All that is worth keeping of a state; None of one that has lost its numbers."""
    x, covariance, learned = snapshot.x, snapshot.P, snapshot.learned
    if not math.isfinite(float(x.sum()) + float(covariance.sum())):
        return None
    stds = np.sqrt(np.maximum(np.diag(covariance), 0.0))
    at = list(CALIBRATED)
    correlations = covariance[np.ix_(at, at)] / np.outer(stds[at], stds[at])
    calibration = SensorCalibration(
        gyro_bias_degps=math.degrees(float(x[S.GYRO_BIAS])),
        gyro_bias_std_degps=math.degrees(float(stds[S.GYRO_BIAS])),
        gyro_scale=float(x[S.GYRO_SCALE]),
        gyro_scale_std=float(stds[S.GYRO_SCALE]),
        odometer_scale=float(x[S.ODOMETER_SCALE]),
        odometer_scale_std=float(stds[S.ODOMETER_SCALE]),
        gps_latency_s=float(x[S.LATENCY]),
        gps_latency_std_s=float(stds[S.LATENCY]),
        correlations=tuple(float(each) for each in correlations[UPPER]),
        gyro_temperature_c=gyro_temperature_c,
        position_noise_factor=learned.position_noise.factor,
        velocity_noise_factor=learned.doppler_noise.factor,
        bias_wander_factor=learned.wander.factor,
    )
    return Saved(t_ns=t_ns, calibration=calibration, pose=_last_pose(x, stds, snapshot.situation))


def _last_pose(x: Floats, stds: Floats, situation: Situation) -> LastPose | None:
    if situation.plane is None or not situation.heading_known:
        return None
    if situation.accepted_fix_ns is None:
        return None
    lat_deg, lon_deg = situation.plane.to_geodetic(float(x[S.EAST]), float(x[S.NORTH]))
    return LastPose(
        lat_deg=lat_deg,
        lon_deg=lon_deg,
        east_std_m=float(stds[S.EAST]),
        north_std_m=float(stds[S.NORTH]),
        heading_deg=wrap_360(math.degrees(float(x[S.HEADING]))),
        heading_std_deg=math.degrees(float(stds[S.HEADING])),
        speed_mps=float(x[S.ODOMETER_SCALE] * x[S.WHEEL_SPEED]),
        fix_ns=situation.accepted_fix_ns,
    )


def resumed(saved: Saved, fresh: Snapshot, t_ns: int, tuning: Tuning) -> Snapshot:
    """The state to start with at an instant, from what was kept and one that knows nothing.

    Before the instant at which it was kept (a drive replayed again, a clock without a battery)
    the calibration is taken as it is, and the pose, of a later time, is not taken.
    """
    calibrated = _calibrated(saved, fresh, t_ns, tuning)
    if saved.pose is None or not is_after(saved, t_ns):
        return calibrated
    off_s = max(t_ns - saved.t_ns, 0) * 1e-9
    pose = _aged_pose(saved.pose, off_s, tuning)
    std_m = max(pose.east_std_m, pose.north_std_m)
    if std_m > USEFUL_STD_M or pose.heading_std_deg > USEFUL_STD_DEG:
        return calibrated
    return _placed(pose, calibrated, off_s)


def is_after(saved: Saved, t_ns: int) -> bool:
    """Whether an instant is later than what was kept, as late as one can tell."""
    return (t_ns - saved.t_ns) * 1e-9 >= -CLOCK_SLACK_S


def _calibrated(saved: Saved, fresh: Snapshot, t_ns: int, tuning: Tuning) -> Snapshot:
    """With the sensors' calibration, aged; never worse known than from the box."""
    x, covariance, at, known = fresh.x.copy(), fresh.P.copy(), list(CALIBRATED), saved.calibration
    x[at] = (
        math.radians(known.gyro_bias_degps),
        known.gyro_scale,
        known.odometer_scale,
        known.gps_latency_s,
    )
    stds = np.array(
        (
            math.radians(known.gyro_bias_std_degps),
            known.gyro_scale_std,
            known.odometer_scale_std,
            known.gps_latency_std_s,
        )
    )
    correlations = np.eye(len(at))
    correlations[UPPER] = correlations.T[UPPER] = known.correlations
    aged = correlations * np.outer(stds, stds)
    aged += np.diag(_ageing(known, max(t_ns - saved.t_ns, 0) * 1e-9, tuning))
    shrink = np.minimum(np.sqrt(np.diag(fresh.P)[at] / np.diag(aged)), 1.0)
    covariance[np.ix_(at, at)] = aged * np.outer(shrink, shrink)
    learned = Learned(
        position_noise=NoiseScale(factor=known.position_noise_factor),
        doppler_noise=NoiseScale(factor=known.velocity_noise_factor),
        wander=BiasWander(factor=known.bias_wander_factor),
    )
    return msgspec.structs.replace(fresh, t_ns=t_ns, x=x, P=covariance, learned=learned)


def _ageing(known: SensorCalibration, off_s: float, tuning: Tuning) -> tuple[float, ...]:
    """Variances that a time switched off adds, in the order of `CALIBRATED`."""
    walk_degps = tuning.gyro_bias_walk_degps_per_sqrt_s * math.sqrt(known.bias_wander_factor)
    wandered_degps = walk_degps * math.sqrt(off_s)
    bias = math.radians(math.hypot(wandered_degps, tuning.gyro_bias_switch_on_std_degps))
    settling_s = min(off_s, SCALES_SETTLE_S)
    return (
        bias**2,
        tuning.gyro_scale_walk_per_sqrt_s**2 * settling_s,
        tuning.odometer_scale_walk_per_sqrt_s**2 * settling_s,
        0.0,
    )


def _aged_pose(pose: LastPose, off_s: float, tuning: Tuning) -> LastPose:
    """Where the vehicle is expected to be after a time unobserved, and how well that is known."""
    speed_mps = abs(pose.speed_mps)
    strayed_m = 0.5 * ACCELERATION_MPS2 * off_s**2
    turned_deg = math.degrees(off_s * LATERAL_MPS2 / max(speed_mps, STOOD_MPS))
    if speed_mps < STOOD_MPS:
        strayed_m = min(strayed_m, tuning.parked_position_std_m)
        turned_deg = min(turned_deg, tuning.parked_heading_std_deg)
    return msgspec.structs.replace(
        pose,
        east_std_m=math.hypot(pose.east_std_m, strayed_m),
        north_std_m=math.hypot(pose.north_std_m, strayed_m),
        heading_std_deg=math.hypot(pose.heading_std_deg, turned_deg),
        speed_mps=0.0 if speed_mps < STOOD_MPS else pose.speed_mps,
    )


def _placed(pose: LastPose, calibrated: Snapshot, off_s: float) -> Snapshot:
    """With a pose, which the first fixes may contradict."""
    x, covariance = calibrated.x.copy(), calibrated.P.copy()
    heading_rad = wrap_pi(math.radians(pose.heading_deg))
    moved_m = pose.speed_mps * off_s
    speed_std_mps = min(
        1.0 + ACCELERATION_MPS2 * off_s, math.sqrt(covariance[S.WHEEL_SPEED, S.WHEEL_SPEED])
    )
    stds = (
        pose.east_std_m,
        pose.north_std_m,
        math.radians(pose.heading_std_deg),
        speed_std_mps,
    )
    x[S.EAST], x[S.NORTH] = moved_m * math.sin(heading_rad), moved_m * math.cos(heading_rad)
    x[S.HEADING], x[S.WHEEL_SPEED] = heading_rad, pose.speed_mps / x[S.ODOMETER_SCALE]
    for state, std in zip(PLACED, stds, strict=True):
        covariance[state, state] = std**2
    situation = Situation(
        plane=LocalPlane(pose.lat_deg, pose.lon_deg),
        heading_known=True,
        placed_ns=pose.fix_ns,
        accepted_fix_ns=pose.fix_ns,
        position_unconfirmed=True,
        heading_unconfirmed=True,
    )
    return msgspec.structs.replace(calibrated, x=x, P=covariance, situation=situation)
