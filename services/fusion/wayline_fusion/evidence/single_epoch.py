"""Pure: place and velocity by one epoch of raw measurements alone, as a receiver finds its fix.

Iterated least squares from the Earth's centre on; ranges that are too long lose their weight once
the place is about right.
"""

import math

import numpy as np
from pyproj import Transformer

from wayline.satellites.range_noise import Signals, one_sided
from wayline.satellites.sight import Ground, Sight, ground_at, seen_from
from wayline_fusion.filter.states import Floats
from wayline_fusion.intake.events import Fix, Ranges

TO_GEODETIC = Transformer.from_crs("EPSG:4978", "EPSG:4979", always_xy=True)
ROUNDS = 20
WEIGHED_FROM = 6
"""Rounds; by then the place is right to what the ranges are wrong by."""
EARTH_M = (5e6, 8e6)
"""From its centre: no vehicle is anywhere else."""
RATE_STD_MPS = 0.3
"""Floor of a range rate's std among reflections."""
STD_MIN_M = 9.0
"""Reflections that agree displace a fix by more than its own ranges tell, m."""


def fix_alone(epoch: Ranges, floor_m: float) -> tuple[Fix, float] | None:
    """A fix and its height above the ellipsoid; None of too few satellites.

    `floor_m` is the std of a strong range from the zenith.
    """
    systems = _columns(epoch.systems)
    if len(epoch.names) < 3 + systems.shape[1]:
        return None
    solved = _placed(epoch, systems, floor_m)
    if solved is None:
        return None
    place_m, weights, std_m = solved
    x_m, y_m, z_m = place_m.tolist()
    lon_deg, lat_deg, height_m = TO_GEODETIC.transform(x_m, y_m, z_m)
    ground = ground_at(lat_deg, lon_deg, height_m)
    sight = seen_from(ground, epoch.places_m, epoch.motions_mps)
    fix = Fix(epoch.t_ns, lat_deg, lon_deg, std_m, *_velocity(epoch, sight, weights))
    return fix, height_m


def _columns(systems: tuple[str, ...]) -> Floats:
    """One for each system's clock."""
    known = sorted(set(systems))
    return np.array([[each == name for name in known] for each in systems], dtype=np.float64)


def _placed(epoch: Ranges, systems: Floats, floor_m: float) -> tuple[Floats, Floats, float] | None:
    """Place, weights of the ranges, and the std of the place per axis."""
    place_m = np.zeros(3)
    weights = np.ones(len(systems))
    for number in range(ROUNDS):
        sight = seen_from(Ground(place_m, np.eye(3)), epoch.places_m, epoch.motions_mps)
        columns = np.hstack((-sight.directions, systems))
        off_m = epoch.pseudoranges_m - sight.ranges_m
        normal = columns.T @ (weights[:, None] * columns)
        if np.linalg.cond(normal) > 1e12:
            return None
        solution = np.linalg.solve(normal, columns.T @ (weights * off_m))
        place_m = place_m + solution[:3]
        if number >= WEIGHED_FROM:
            if not EARTH_M[0] < float(np.linalg.norm(place_m)) < EARTH_M[1]:
                return None
            sines = sight.directions @ (place_m / np.linalg.norm(place_m))
            stds_m = Signals(epoch.stds_m, sines, epoch.cn0_dbhz).stds_m(floor_m)
            left_m = off_m - columns @ solution
            weights = one_sided(left_m / stds_m, 2.0) / stds_m**2
    covariance = np.linalg.inv(normal)[:3, :3]
    # residuals larger than the stds say that the place is as much worse
    free = max(len(weights) - columns.shape[1], 1)
    scatter = max(math.sqrt(float(np.sum(weights * left_m**2)) / free), 1.0)
    std_m = scatter * math.sqrt(float(np.trace(covariance)))
    return place_m, weights, math.hypot(STD_MIN_M, std_m)


def _velocity(
    epoch: Ranges, sight: Sight, weights: Floats
) -> tuple[float | None, float, float, float | None, float | None]:
    """Speed, its std twice, course and its std, where enough range rates tell."""
    told = np.flatnonzero(np.isfinite(epoch.rates_mps) & np.isfinite(sight.range_rates_mps))
    if len(told) < 4:
        return None, RATE_STD_MPS, RATE_STD_MPS, None, None
    columns = np.column_stack((-sight.directions[told], np.ones(len(told))))
    off_mps = epoch.rates_mps[told] - sight.range_rates_mps[told]
    weight = np.sqrt(weights[told] / weights[told].max())
    solution, *_ = np.linalg.lstsq(weight[:, None] * columns, weight * off_mps, rcond=None)
    spread = np.linalg.pinv(columns.T @ (weight[:, None] ** 2 * columns))
    east_mps, north_mps = float(solution[0]), float(solution[1])
    std_mps = RATE_STD_MPS * math.sqrt(max(float(spread[0, 0] + spread[1, 1]) / 2.0, 0.1))
    speed_mps = math.hypot(east_mps, north_mps)
    course_std_rad = std_mps / max(speed_mps, std_mps)
    return speed_mps, std_mps, std_mps, math.atan2(east_mps, north_mps), course_std_rad
