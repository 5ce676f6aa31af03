"""Pure: takes the yardstick through a drive; what it says has the shape of fusion's poses."""

from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

from wayline_evaluation.circumstances import Circumstances, circumstances, within
from wayline_evaluation.estimates import Estimates, Floats
from wayline_evaluation.motion import motion_at
from wayline_evaluation.plane import Grid
from wayline_evaluation.sensed import Sensed, without_speeds
from wayline_evaluation.yardstick import Yardstick
from wayline_evaluation.yardstick_altitude import told_altitudes
from wayline_evaluation.yardstick_state import YardstickStates
from wayline_simulator.facts import Facts
from wayline_simulator.happenings import Happenings, Span

DEAD_RECKONING_S = 2.0
"""Without a fix for so long the pose is dead reckoning (SPEC section 2)."""
SPOILT_S = 0.1
"""Beside spinning or locked wheels: a frame's time wanders, and a spin begins softly."""


def told_estimates(
    poses_s: Floats,
    sensed: Sensed,
    facts: Facts,
    *,
    fixes_early_s: float = 0.0,
    grade_walk_pct2_per_m: float,
) -> Estimates:
    """The yardstick's estimates at fusion's instants.

    A fix describes the vehicle `fixes_early_s` after the t_ns that ingest gave it. Raises
    ValueError where the vehicle has no gyro or no wheels.
    """
    if facts.gps is None or facts.gyro is None or facts.odometer is None:
        raise ValueError("the yardstick needs GPS, a gyro and an odometer")
    sensed = without_speeds(sensed, _spoilt(sensed, facts.happenings))
    there = _circumstances(sensed, facts, fixes_early_s)
    fixes = [(fix.t_ns * 1e-9 + fixes_early_s, fix) for fix in sensed.fixes]
    instants_s = np.union1d(poses_s, [time_s for time_s, _ in fixes])
    low_mps = facts.odometer.resolution_mps / 2.0 if facts.odometer.truncated else 0.0
    motion = motion_at(instants_s, sensed, wheels_low_mps=low_mps)
    filter_ = Yardstick(facts.gps, facts.gyro, facts.odometer, facts.happenings, sensed)
    waiting = [(int(np.searchsorted(instants_s, time_s)), fix) for time_s, fix in fixes]
    grid = _grid(sensed)
    log = np.full((len(instants_s), len(Logged)), np.nan)
    distance_m, fixed_s, number = 0.0, -np.inf, 0
    for step, time_s in enumerate(instants_s):
        if step:
            filter_.advance(motion, step, float(time_s) - sensed.start_s)
            distance_m += abs(filter_.scale * float(motion.driven_m[step]))
        wheels_mps = float(motion.speeds_mps[step])
        while number < len(waiting) and waiting[number][0] <= step:
            filter_.correct(waiting[number][1], there[number], grid, wheels_mps)
            fixed_s, number = float(time_s), number + 1
        if number:
            log[step] = _logged(filter_, wheels_mps, distance_m, float(time_s) - fixed_s)
    rows = np.searchsorted(instants_s, poses_s)
    return told_altitudes(
        _estimates(poses_s, log[rows], grid),
        sensed,
        facts,
        there,
        fixes_early_s=fixes_early_s,
        grade_walk_pct2_per_m=grade_walk_pct2_per_m,
    )


def _circumstances(sensed: Sensed, facts: Facts, fixes_early_s: float) -> list[Circumstances]:
    latency_s = facts.gps.latency_s if facts.gps else 0.0
    told_s = np.array([fix.t_ns for fix in sensed.fixes], dtype=np.float64) * 1e-9
    described_s = told_s + fixes_early_s
    return circumstances(described_s, described_s + latency_s, sensed.blind_s, facts.happenings)


def _spoilt(sensed: Sensed, happened: Happenings) -> NDArray[np.bool_]:
    """Wheel speeds of spinning or locked wheels: it is told, and bridges them."""
    wider = [Span(a - SPOILT_S, b + SPOILT_S) for a, b in happened.slips]
    return within(sensed.speed_mps.times_s, wider)


def _grid(sensed: Sensed) -> Grid:
    """About the middle of the drive's fixes."""
    if not sensed.fixes:
        raise ValueError("the yardstick needs a fix")
    lats_deg, lons_deg = (
        [value for fix in sensed.fixes if (value := getattr(fix, name)) is not None]
        for name in ("lat_deg", "lon_deg")
    )
    return Grid(float(np.median(lats_deg)), float(np.median(lons_deg)))


class Logged(IntEnum):
    """Columns of what is kept of every instant."""

    EAST = 0
    NORTH = 1
    HEADING = 2
    SPEED = 3
    DISTANCE = 4
    EAST_STD = 5
    NORTH_STD = 6
    COVARIANCE = 7
    HEADING_STD = 8
    SPEED_STD = 9
    BLIND = 10


def _logged(filter_: Yardstick, wheels_mps: float, distance_m: float, blind_s: float) -> Floats:
    mean, covariance = filter_.state.mean, filter_.state.covariance
    stds = np.sqrt(np.diagonal(covariance))
    speed_mps, speed_std_mps = filter_.speed(wheels_mps)
    heading = filter_.heading_known
    return np.array(
        [
            mean[YardstickStates.EAST],
            mean[YardstickStates.NORTH],
            mean[YardstickStates.HEADING] if heading else np.nan,
            speed_mps,
            distance_m,
            stds[YardstickStates.EAST],
            stds[YardstickStates.NORTH],
            covariance[YardstickStates.EAST, YardstickStates.NORTH],
            stds[YardstickStates.HEADING] if heading else np.nan,
            speed_std_mps,
            blind_s,
        ]
    )


def _estimates(times_s: Floats, log: Floats, grid: Grid) -> Estimates:
    lats_deg, lons_deg = grid.to_geodetic(log[:, Logged.EAST], log[:, Logged.NORTH])
    headings_deg = np.degrees(log[:, Logged.HEADING]) + grid.convergence_deg(lats_deg, lons_deg)
    unknown = np.full(len(times_s), np.nan)
    return Estimates(
        times_s=times_s,
        lats_deg=lats_deg,
        lons_deg=lons_deg,
        alts_m=unknown,
        headings_deg=headings_deg % 360.0,
        speeds_mps=log[:, Logged.SPEED],
        grades_pct=unknown,
        distances_m=log[:, Logged.DISTANCE],
        east_stds_m=log[:, Logged.EAST_STD],
        north_stds_m=log[:, Logged.NORTH_STD],
        east_north_covs_m2=log[:, Logged.COVARIANCE],
        heading_stds_deg=np.degrees(log[:, Logged.HEADING_STD]),
        speed_stds_mps=log[:, Logged.SPEED_STD],
        alt_stds_m=unknown,
        grade_stds_pct=unknown,
        dead_reckoning=log[:, Logged.BLIND] > DEAD_RECKONING_S,
    )
