"""Pure: what a filter said of a vehicle, as arrays over time."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wayline.messages import Pose

Floats = NDArray[np.float64]


def turn_between(times_s: Floats, known_s: Floats, angles_deg: Floats) -> Floats:
    """Angles at instants, the short way round, 0 <= x < 360; nan outside the known ones."""
    angles_rad = np.radians(angles_deg)
    sin, cos = (
        np.interp(times_s, known_s, part, left=np.nan, right=np.nan)
        for part in (np.sin(angles_rad), np.cos(angles_rad))
    )
    turned_deg: Floats = np.degrees(np.arctan2(sin, cos)) % 360.0
    return np.where(turned_deg == 360.0, 0.0, turned_deg)


@dataclass(frozen=True, slots=True)
class Estimates:
    """Poses in order of time, shape (n,) each, nan where unknown; stds are one sigma."""

    times_s: Floats
    """Unix."""
    lats_deg: Floats
    lons_deg: Floats
    alts_m: Floats
    headings_deg: Floats
    speeds_mps: Floats
    """Negative in reverse."""
    grades_pct: Floats
    distances_m: Floats
    """Travelled since the start."""
    east_stds_m: Floats
    north_stds_m: Floats
    east_north_covs_m2: Floats
    heading_stds_deg: Floats
    speed_stds_mps: Floats
    alt_stds_m: Floats
    grade_stds_pct: Floats
    dead_reckoning: NDArray[np.bool_]

    def at(self, times_s: Floats) -> "Estimates":
        """Between the poses that have a position; the last one holds, before the first is nan."""
        located = ~np.isnan(self.lats_deg)
        rows = np.flatnonzero(located if located.any() else np.ones_like(located))
        known_s = self.times_s[rows]
        within_s = np.minimum(times_s, known_s[-1])

        def between(values: Floats) -> Floats:
            return np.asarray(np.interp(within_s, known_s, values[rows], left=np.nan))

        last = rows[np.clip(np.searchsorted(known_s, within_s, "right") - 1, 0, len(rows) - 1)]
        return Estimates(
            times_s=times_s,
            lats_deg=between(self.lats_deg),
            lons_deg=between(self.lons_deg),
            alts_m=between(self.alts_m),
            headings_deg=turn_between(within_s, known_s, self.headings_deg[rows]),
            speeds_mps=between(self.speeds_mps),
            grades_pct=between(self.grades_pct),
            distances_m=between(self.distances_m),
            east_stds_m=between(self.east_stds_m),
            north_stds_m=between(self.north_stds_m),
            east_north_covs_m2=between(self.east_north_covs_m2),
            heading_stds_deg=between(self.heading_stds_deg),
            speed_stds_mps=between(self.speed_stds_mps),
            alt_stds_m=between(self.alt_stds_m),
            grade_stds_pct=between(self.grade_stds_pct),
            dead_reckoning=self.dead_reckoning[last],
        )


def estimates_of(poses: Sequence[Pose]) -> Estimates:
    """Fusion's poses as arrays."""

    def column(name: str) -> Floats:
        # numpy makes nan of None
        return np.array([getattr(pose, name) for pose in poses], dtype=np.float64)

    return Estimates(
        times_s=column("t_ns") * 1e-9,
        lats_deg=column("lat_deg"),
        lons_deg=column("lon_deg"),
        alts_m=column("alt_m"),
        headings_deg=column("heading_deg"),
        speeds_mps=column("speed_mps"),
        grades_pct=column("grade_pct"),
        distances_m=column("distance_m"),
        east_stds_m=column("east_std_m"),
        north_stds_m=column("north_std_m"),
        east_north_covs_m2=column("east_north_cov_m2"),
        heading_stds_deg=column("heading_std_deg"),
        speed_stds_mps=column("speed_std_mps"),
        alt_stds_m=column("alt_std_m"),
        grade_stds_pct=column("grade_std_pct"),
        dead_reckoning=np.array(
            [pose.mode in ("dead_reckoning", "lost") for pose in poses], dtype=np.bool_
        ),
    )
