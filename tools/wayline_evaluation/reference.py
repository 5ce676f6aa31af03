"""Pure: what estimates are judged by: the truth of a drive, or the fixes it recorded."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from wayline.geo import WGS84
from wayline.messages import GpsFix
from wayline_evaluation.estimates import Estimates, Floats, turn_between

Kind = Literal["truth", "fixes"]
MOVED_M = 0.05
"""A shorter step of a track has no direction of its own: coordinates are rounded."""


@dataclass(frozen=True, slots=True)
class Reference:
    """Samples in order of time, shape (n,) each, nan where unknown."""

    kind: Kind
    times_s: Floats
    """Unix."""
    lats_deg: Floats
    lons_deg: Floats
    alts_m: Floats
    headings_deg: Floats
    speeds_mps: Floats
    grades_pct: Floats
    distances_m: Floats
    """Horizontal, travelled since the first sample."""
    directions_deg: Floats
    """Which along-track and cross-track are counted in: the heading, else the track's."""

    def at(self, times_s: Floats) -> "Reference":
        """Between the samples; nan outside them."""

        def between(values: Floats) -> Floats:
            return np.interp(times_s, self.times_s, values, left=np.nan, right=np.nan)

        return Reference(
            kind=self.kind,
            times_s=times_s,
            lats_deg=between(self.lats_deg),
            lons_deg=between(self.lons_deg),
            alts_m=between(self.alts_m),
            headings_deg=turn_between(times_s, self.times_s, self.headings_deg),
            speeds_mps=between(self.speeds_mps),
            grades_pct=between(self.grades_pct),
            distances_m=between(self.distances_m),
            directions_deg=turn_between(times_s, self.times_s, self.directions_deg),
        )


def true_reference(
    times_s: Floats,
    lats_deg: Floats,
    lons_deg: Floats,
    *,
    alts_m: Floats | None = None,
    headings_deg: Floats | None = None,
    speeds_mps: Floats | None = None,
    grades_pct: Floats | None = None,
) -> Reference:
    """The truth from what is known of it; times must increase."""
    unknown = np.full(len(times_s), np.nan)
    bearings_deg, _, steps_m = WGS84.inv(lons_deg[:-1], lats_deg[:-1], lons_deg[1:], lats_deg[1:])
    headings = unknown if headings_deg is None else headings_deg
    return Reference(
        kind="truth",
        times_s=times_s,
        lats_deg=lats_deg,
        lons_deg=lons_deg,
        alts_m=unknown if alts_m is None else alts_m,
        headings_deg=headings,
        speeds_mps=unknown if speeds_mps is None else speeds_mps,
        grades_pct=unknown if grades_pct is None else grades_pct,
        distances_m=np.concatenate(([0.0], np.cumsum(steps_m))),
        directions_deg=_held(bearings_deg, steps_m) if headings_deg is None else headings,
    )


def fixes_reference(fixes: Sequence[GpsFix], undisturbed: Estimates) -> Reference:
    """The recorded fixes, for a drive without a truth.

    Direction and distance are those of a replay without an outage: fixes wander at rest.
    """
    valid = [fix for fix in fixes if fix.valid]
    times_s = np.array([fix.t_ns for fix in valid], dtype=np.float64) * 1e-9
    order = np.argsort(times_s, kind="stable")
    unknown = np.full(len(valid), np.nan)
    poses = undisturbed.at(times_s[order])
    return Reference(
        kind="fixes",
        times_s=times_s[order],
        lats_deg=np.array([fix.lat_deg for fix in valid], dtype=np.float64)[order],
        lons_deg=np.array([fix.lon_deg for fix in valid], dtype=np.float64)[order],
        alts_m=unknown,
        headings_deg=unknown,
        speeds_mps=unknown,
        grades_pct=unknown,
        distances_m=poses.distances_m,
        directions_deg=poses.headings_deg,
    )


def _held(bearings_deg: Floats, steps_m: Floats) -> Floats:
    """Direction at every sample: of the step after it, or of the last one that moved."""
    moved = np.flatnonzero(steps_m >= MOVED_M)
    if len(moved) == 0:
        return np.full(len(steps_m) + 1, np.nan)
    samples = np.arange(len(steps_m) + 1)
    last = np.clip(np.searchsorted(moved, samples, "right") - 1, 0, len(moved) - 1)
    directions_deg: Floats = np.asarray(bearings_deg)[moved[last]] % 360.0
    return directions_deg
