"""Pure: what a filter must hold on the scenarios that were made for one trouble each."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wayline.geo import WGS84
from wayline.messages import GpsFix
from wayline_evaluation.circumstances import within
from wayline_evaluation.estimates import Estimates, Floats
from wayline_evaluation.pose_errors import PoseErrors
from wayline_evaluation.reference import Reference
from wayline_simulator.happenings import Happenings, Span

MOVES_S = 3.0
"""A fix that is let in moves the pose at once; later moves come of later fixes."""
NEAR_M = 15.0
"""Nearer than this good fixes have won."""
SETTLED_S = 10.0
"""After the first fix a pose is asked to be right (issue 7)."""
ENDLESS_S = float("inf")


class Cluster(NamedTuple):
    """What fixes that agree with each other, and are wrong, did to the poses."""

    pull_m: float
    """How far the fixes moved the poses at most."""
    recovery_s: float
    """From the last wrong fix until poses stay near the truth; infinite where they never do."""


class Start(NamedTuple):
    """A pose some seconds after the first fix, in magnitude."""

    horizontal_m: float
    heading_deg: float
    speed_mps: float


class Trip(NamedTuple):
    """A drive with nothing but a receiver."""

    position_ratio: float
    """Root mean square of the poses over that of the fixes."""
    speed_mps: float
    """Root mean square."""
    distance_pct: float
    """Travelled too much (positive) or too little."""


def moved_m(errors: PoseErrors, span: Span) -> float:
    """How far the output was moved, against its error at the last pose before the span."""
    before = np.flatnonzero(errors.times_s < span.start_s)
    during = (errors.times_s >= span.start_s) & (errors.times_s < span.end_s + MOVES_S)
    return _farthest_m(errors, int(before[-1]), during)


def cluster(errors: PoseErrors, span: Span) -> Cluster:
    """Pull while it lasts, and how long good fixes need then."""
    before = np.flatnonzero(errors.times_s < span.start_s)
    during = (errors.times_s >= span.start_s) & (errors.times_s < span.end_s)
    after = np.flatnonzero(errors.times_s >= span.end_s)
    far = after[errors.horizontal_m[after] > NEAR_M]
    if not len(far):
        recovery_s = 0.0
    elif far[-1] == len(errors.times_s) - 1:
        recovery_s = ENDLESS_S
    else:
        recovery_s = float(errors.times_s[far[-1] + 1]) - span.end_s
    return Cluster(_farthest_m(errors, int(before[-1]), during), recovery_s)


def _farthest_m(errors: PoseErrors, row: int, rows: NDArray[np.bool_]) -> float:
    """From the error of one pose to those of others."""
    east_m, north_m = errors.east_m - errors.east_m[row], errors.north_m - errors.north_m[row]
    return float(np.nanmax(np.hypot(east_m, north_m)[rows]))


def surrounded(happened: Happenings, kind: int, end_s: float) -> tuple[Span, ...]:
    """When a vehicle was among some kind of surroundings."""
    ends_s = [change.time_s for change in happened.surroundings[1:]] + [end_s]
    return tuple(
        Span(change.time_s, until_s)
        for change, until_s in zip(happened.surroundings, ends_s, strict=True)
        if change.surroundings == kind
    )


def fix_errors_m(fixes: Sequence[GpsFix], truth: Reference) -> tuple[Floats, Floats]:
    """Instants of the valid fixes (Unix) and their distances from the truth."""
    valid = [fix for fix in fixes if fix.valid]
    times_s = np.array([fix.t_ns for fix in valid], dtype=np.float64) * 1e-9
    there = truth.at(times_s)
    known = ~np.isnan(there.lats_deg)
    lats_deg = np.array([fix.lat_deg for fix in valid], dtype=np.float64)
    lons_deg = np.array([fix.lon_deg for fix in valid], dtype=np.float64)
    _, _, apart_m = WGS84.inv(
        there.lons_deg[known], there.lats_deg[known], lons_deg[known], lats_deg[known]
    )
    return times_s[known], np.asarray(apart_m)


def canyon_ratio(
    errors: PoseErrors, fix_times_s: Floats, fixes_m: Floats, canyons: Sequence[Span]
) -> float | None:
    """95th percentile of the poses over that of the raw fixes, in canyons; None without both."""
    poses_m = errors.horizontal_m[within(errors.times_s, canyons)]
    raw_m = fixes_m[within(fix_times_s, canyons)]
    poses_m = poses_m[~np.isnan(poses_m)]
    if not len(poses_m) or not len(raw_m):
        return None
    return float(np.percentile(poses_m, 95.0) / np.percentile(raw_m, 95.0))


def worst_m(errors: PoseErrors, spans: Sequence[Span]) -> float | None:
    """Largest error inside; None where nothing was inside."""
    inside_m = errors.horizontal_m[within(errors.times_s, spans)]
    inside_m = inside_m[~np.isnan(inside_m)]
    return float(np.max(inside_m)) if len(inside_m) else None


def start(errors: PoseErrors, first_fix_s: float) -> Start:
    """The first pose that is `SETTLED_S` after the first fix."""
    row = int(np.searchsorted(errors.times_s, first_fix_s + SETTLED_S))
    return Start(
        float(errors.horizontal_m[row]),
        abs(float(errors.heading_deg[row])),
        abs(float(errors.speed_mps[row])),
    )


def trip(estimates: Estimates, errors: PoseErrors, fixes_m: Floats, truth: Reference) -> Trip:
    """Of a whole drive; its distance is counted from the first pose with a position."""
    located = np.flatnonzero(~np.isnan(estimates.lats_deg))
    ends_s = estimates.times_s[located[[0, -1]]]
    true_m = float(np.diff(np.interp(ends_s, truth.times_s, truth.distances_m))[0])
    gone_m = float(np.diff(estimates.distances_m[located[[0, -1]]])[0])
    return Trip(
        position_ratio=_rms(errors.horizontal_m) / _rms(fixes_m),
        speed_mps=_rms(errors.speed_mps),
        distance_pct=100.0 * (gone_m / true_m - 1.0),
    )


def _rms(values: Floats) -> float:
    return float(np.sqrt(np.nanmean(np.square(values))))
