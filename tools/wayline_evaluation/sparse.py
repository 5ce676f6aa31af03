"""Pure: how a vehicle is followed by fixes that come seldom: at each, and before the next one."""

from collections.abc import Sequence
from dataclasses import dataclass

import msgspec
import numpy as np

from wayline.geo import WGS84
from wayline.messages import GpsFix
from wayline_evaluation.estimates import Floats
from wayline_evaluation.figures import Figures, Inside, consistency_of, figures_of
from wayline_evaluation.pose_errors import PoseErrors, pose_errors
from wayline_evaluation.reference import Kind, Reference
from wayline_evaluation.replay_result import Replayed

SETTLED_S = 0.2
"""A pose of the ten a second that is so much later has heard of the fix."""
NEAR_S = 1.5
"""Between a fix and the poses beside it, where there are any."""
SHORT_S = 0.05
"""Poses so close before a fix may be of its own instant."""
HOLE_S = 5.0
"""Between recorded fixes the way is not known over more than this."""


class SparseScore(msgspec.Struct, frozen=True, kw_only=True):
    """One drive, with fixes so seldom."""

    drive: str
    every_s: float
    reference: Kind
    fixes: int
    """Valid ones that were told."""
    accepted_share: float | None
    """Of the positions that were judged."""
    lost_share: float
    """Of the poses."""
    at_fix_m: Figures | None
    before_next_m: Figures | None
    """Of the last pose before the next fix."""
    straight_on_m: Figures | None
    """At the same instants, by going on from the last fix along its course, with its speed."""
    between: Inside | None
    """Positions between fixes, inside the ellipses of 1 and 2 sigma."""
    heading_deg: Figures | None


class SparseReport(msgspec.Struct, frozen=True, kw_only=True):
    """What `wayline evaluate sparse --json` writes."""

    scores: tuple[SparseScore, ...]


@dataclass(frozen=True, slots=True)
class SparseRun:
    """One drive with fixes so seldom: its score, and the errors behind it."""

    score: SparseScore
    errors: PoseErrors
    fixes_s: Floats


def sparse_run(there: Replayed, reference: Reference, every_s: float) -> SparseRun:
    """Score a replay; the first fix, before which nothing is known, counts for nothing."""
    poses_s = there.estimates.times_s
    valid = [fix for fix in there.fixes if fix.valid]
    fixes_s = np.array([fix.t_ns for fix in valid]) * 1e-9
    errors = pose_errors(there.estimates, _known(reference, poses_s))
    before, of_fix = _last_before(poses_s, fixes_s)
    between = errors.where((poses_s > fixes_s[0]) & (poses_s < fixes_s[-1]))
    judged = [each.accepted for each in there.verdicts if each.sensor == "gps_position"]
    score = SparseScore(
        drive=there.drive,
        every_s=every_s,
        reference=reference.kind,
        fixes=len(valid),
        accepted_share=float(np.mean(judged)) if judged else None,
        lost_share=there.lost_share,
        at_fix_m=figures_of(errors.horizontal_m[_first_at(poses_s, fixes_s)]),
        before_next_m=figures_of(errors.horizontal_m[before]),
        straight_on_m=figures_of(_straight_on(valid, of_fix, poses_s[before], reference)),
        between=consistency_of(between).ellipse,
        heading_deg=figures_of(between.heading_deg),
    )
    return SparseRun(score, errors, fixes_s)


def _known(reference: Reference, times_s: Floats) -> Reference:
    """Where the way is known at instants; what was recorded says nothing over long holes."""
    there = reference.at(times_s)
    if reference.kind == "truth":
        return there
    after = np.clip(np.searchsorted(reference.times_s, times_s), 1, len(reference.times_s) - 1)
    is_hole = reference.times_s[after] - reference.times_s[after - 1] > HOLE_S
    there.lats_deg[is_hole] = np.nan
    return there


def _first_at(poses_s: Floats, fixes_s: Floats) -> np.ndarray:
    """Indices of the poses that tell of each fix but the first, at its own instant if there."""
    own = np.clip(np.searchsorted(poses_s, fixes_s[1:] - 1e-4), 0, len(poses_s) - 1)
    later = np.clip(np.searchsorted(poses_s, fixes_s[1:] + SETTLED_S), 0, len(poses_s) - 1)
    is_dense = np.median(np.diff(poses_s)) < 0.5
    found = later if is_dense else own
    near = poses_s[found] - fixes_s[1:] <= NEAR_S
    return np.asarray(found[near])


def _last_before(poses_s: Floats, fixes_s: Floats) -> tuple[np.ndarray, np.ndarray]:
    """Indices of the last poses before each fix from the third on, and of the fixes before."""
    nexts = np.arange(2, len(fixes_s))
    found = np.searchsorted(poses_s, fixes_s[nexts] - SHORT_S) - 1
    near = (fixes_s[nexts] - poses_s[found] <= NEAR_S) & (poses_s[found] > fixes_s[nexts - 1])
    return np.asarray(found[near]), np.asarray(nexts[near] - 1)


def _straight_on(
    fixes: Sequence[GpsFix], of_fix: np.ndarray, times_s: Floats, reference: Reference
) -> Floats:
    """How far a filter is off that goes on from the last fix as that says, or the last two."""
    rows = [_ahead(fixes[i - 1], fixes[i]) for i in of_fix]
    lats, lons, courses, speeds, fix_s = np.array(rows, dtype=np.float64).reshape(-1, 5).T
    ahead_m = speeds * (times_s - fix_s)
    on_lons, on_lats, _ = WGS84.fwd(lons, lats, courses, ahead_m)
    there = _known(reference, times_s)
    _, _, off_m = WGS84.inv(on_lons, on_lats, there.lons_deg, there.lats_deg)
    return np.asarray(np.where(np.isnan(there.lats_deg), np.nan, off_m))


def _ahead(before: GpsFix, fix: GpsFix) -> tuple[float | None, ...]:
    course_deg, speed_mps = fix.course_deg, fix.speed_mps
    if course_deg is None or speed_mps is None:
        azimuth_deg, _, way_m = WGS84.inv(before.lon_deg, before.lat_deg, fix.lon_deg, fix.lat_deg)
        course_deg = azimuth_deg if course_deg is None else course_deg
        if speed_mps is None:
            speed_mps = way_m / ((fix.t_ns - before.t_ns) * 1e-9)
    return fix.lat_deg, fix.lon_deg, course_deg, speed_mps, fix.t_ns * 1e-9
