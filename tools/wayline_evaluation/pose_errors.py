"""Pure: how far estimates are from a reference, in metres and in their own sigmas."""

from collections.abc import Sequence
from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from wayline.geo import WGS84
from wayline_evaluation.estimates import Estimates, Floats
from wayline_evaluation.reference import Reference

Mask = NDArray[np.bool_]


@dataclass(frozen=True, slots=True)
class PoseErrors:
    """Estimate minus reference at the same instants, shape (n,) each, nan where unknown."""

    times_s: Floats
    dead_reckoning: Mask
    east_m: Floats
    north_m: Floats
    along_track_m: Floats
    """Positive ahead of the truth."""
    cross_track_m: Floats
    """Positive right of the truth."""
    heading_deg: Floats
    speed_mps: Floats
    alt_m: Floats
    grade_pct: Floats
    east_std_m: Floats
    north_std_m: Floats
    east_north_cov_m2: Floats
    heading_std_deg: Floats
    speed_std_mps: Floats
    alt_std_m: Floats
    grade_std_pct: Floats

    @property
    def horizontal_m(self) -> Floats:
        """Distance between estimate and reference."""
        return np.hypot(self.east_m, self.north_m)

    def nees(self) -> Floats:
        """Normalised estimation error squared of the position: chi-square of two, mean 2."""
        east_m2, north_m2 = np.square(self.east_std_m), np.square(self.north_std_m)
        determinant = east_m2 * north_m2 - np.square(self.east_north_cov_m2)
        weighted = (
            north_m2 * np.square(self.east_m)
            - 2.0 * self.east_north_cov_m2 * self.east_m * self.north_m
            + east_m2 * np.square(self.north_m)
        )
        unknown = np.full(len(determinant), np.nan)
        nees: Floats = np.divide(weighted, determinant, out=unknown, where=determinant > 0.0)
        return nees

    def where(self, mask: Mask) -> "PoseErrors":
        """The errors at some of the instants."""
        return PoseErrors(*(getattr(self, field.name)[mask] for field in fields(self)))


def pose_errors(estimates: Estimates, reference: Reference) -> PoseErrors:
    """Errors at the instants that both describe; no alignment."""
    azimuths_rad, distances_m = _apart(estimates, reference)
    from_track_rad = azimuths_rad - np.radians(reference.directions_deg)
    turned_deg = estimates.headings_deg - reference.headings_deg
    return PoseErrors(
        times_s=estimates.times_s,
        dead_reckoning=estimates.dead_reckoning,
        east_m=distances_m * np.sin(azimuths_rad),
        north_m=distances_m * np.cos(azimuths_rad),
        along_track_m=distances_m * np.cos(from_track_rad),
        cross_track_m=distances_m * np.sin(from_track_rad),
        heading_deg=(turned_deg + 180.0) % 360.0 - 180.0,
        speed_mps=estimates.speeds_mps - reference.speeds_mps,
        alt_m=estimates.alts_m - reference.alts_m,
        grade_pct=estimates.grades_pct - reference.grades_pct,
        east_std_m=estimates.east_stds_m,
        north_std_m=estimates.north_stds_m,
        east_north_cov_m2=estimates.east_north_covs_m2,
        heading_std_deg=estimates.heading_stds_deg,
        speed_std_mps=estimates.speed_stds_mps,
        alt_std_m=estimates.alt_stds_m,
        grade_std_pct=estimates.grade_stds_pct,
    )


def compared(estimates: Estimates, reference: Reference) -> PoseErrors:
    """At every pose where the truth is known, else at every recorded fix."""
    if reference.kind == "truth":
        there = reference.at(estimates.times_s)
        errors = pose_errors(estimates, there)
        return errors.where(~np.isnan(there.lats_deg))
    return pose_errors(estimates.at(reference.times_s), reference)


def pooled(errors: Sequence[PoseErrors]) -> PoseErrors:
    """The errors of many drives as one, each instant counting alike."""
    return PoseErrors(
        *(
            np.concatenate([getattr(each, field.name) for each in errors])
            for field in fields(PoseErrors)
        )
    )


def _apart(estimates: Estimates, reference: Reference) -> tuple[Floats, Floats]:
    """Azimuth (rad) and length (m) of the way from the reference to the estimate."""
    known = ~(np.isnan(estimates.lats_deg) | np.isnan(reference.lats_deg))
    azimuths_rad, distances_m = np.full((2, len(known)), np.nan)
    azimuths_deg, _, distances_m[known] = WGS84.inv(
        reference.lons_deg[known],
        reference.lats_deg[known],
        estimates.lons_deg[known],
        estimates.lats_deg[known],
    )
    azimuths_rad[known] = np.radians(azimuths_deg)
    return azimuths_rad, distances_m
