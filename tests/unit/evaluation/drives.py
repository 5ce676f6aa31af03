"""A straight road with a truth, and estimates that are off it by known amounts."""

import numpy as np

from wayline.geo import WGS84
from wayline_evaluation.estimates import Estimates, Floats
from wayline_evaluation.reference import Reference, true_reference

START_S = 1_700_000_000.0
SPEED_MPS = 10.0
LAT_DEG, LON_DEG = 56.0, 10.0


def eastwards(seconds: float = 100.0, *, with_heading: bool = True) -> Reference:
    """10 m/s to the east on the level, ten samples a second."""
    times_s = START_S + np.arange(seconds * 10.0 + 1.0) / 10.0
    lats_deg, lons_deg = _ahead(times_s)
    level = np.zeros(len(times_s))
    return true_reference(
        times_s,
        lats_deg,
        lons_deg,
        alts_m=level + 50.0,
        headings_deg=level + 90.0 if with_heading else None,
        speeds_mps=level + SPEED_MPS,
        grades_pct=level,
    )


def off(
    reference: Reference,
    *,
    right_m: Floats | float = 0.0,
    ahead_m: Floats | float = 0.0,
    heading_deg: float = 0.0,
    std_m: float = 1.0,
    dead_from_s: float = np.inf,
) -> Estimates:
    """Estimates at the reference's instants, right and ahead of it, sure to `std_m` per axis."""
    count = len(reference.times_s)
    right, ahead = np.zeros(count) + right_m, np.zeros(count) + ahead_m
    azimuths_deg = reference.directions_deg + np.degrees(np.arctan2(right, ahead))
    lons_deg, lats_deg, _ = WGS84.fwd(
        reference.lons_deg, reference.lats_deg, azimuths_deg, np.hypot(right, ahead)
    )
    ones = np.ones(count)
    return Estimates(
        times_s=reference.times_s,
        lats_deg=np.asarray(lats_deg),
        lons_deg=np.asarray(lons_deg),
        alts_m=reference.alts_m + 2.0,
        headings_deg=(reference.directions_deg + heading_deg) % 360.0,
        speeds_mps=reference.speeds_mps - 0.5,
        grades_pct=reference.grades_pct + 1.0,
        distances_m=reference.distances_m,
        east_stds_m=std_m * ones,
        north_stds_m=std_m * ones,
        east_north_covs_m2=0.0 * ones,
        heading_stds_deg=ones,
        speed_stds_mps=ones,
        alt_stds_m=ones,
        grade_stds_pct=ones,
        dead_reckoning=reference.times_s >= START_S + dead_from_s,
    )


def _ahead(times_s: Floats) -> tuple[Floats, Floats]:
    here = np.full(len(times_s), LON_DEG), np.full(len(times_s), LAT_DEG)
    lons_deg, lats_deg, _ = WGS84.fwd(
        *here, np.full(len(times_s), 90.0), SPEED_MPS * (times_s - times_s[0])
    )
    return np.asarray(lats_deg), np.asarray(lons_deg)
