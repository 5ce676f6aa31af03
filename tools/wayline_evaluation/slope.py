"""Pure: grade of several runs of one road: against the truth, and run against run."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import Literal

import msgspec
import numpy as np

from wayline_evaluation.estimates import Floats
from wayline_evaluation.figures import Figures, figures_of
from wayline_evaluation.reference import Reference
from wayline_evaluation.slope_hills import correlation_of, hills_shift_m

SPACING_M = 20.0
"""Between the points at which runs are compared: enough for main roads (papers/004, 5.5)."""
Against = Literal["truth", "reference", "each other"]


class SlopeAccuracy(msgspec.Struct, frozen=True, kw_only=True):
    """Of one way to know the grade.

    Errors of runs that are held against each other are their differences, two by two.
    """

    shift_s: float
    """By which it was moved back in time before it was compared, as papers/004 does."""
    grade_pct: Figures | None
    """Errors, all runs pooled."""
    mean_pct: float | None = None
    """Mean error, uphill positive; null where runs are held against each other."""
    inside_share: float | None = None
    """Share of the errors within one claimed std; null where none is claimed."""
    correlation: float | None = None
    """Mean over the runs, or over their pairs."""
    hills_shift_m: float | None = None
    """How much farther along the road its hills come; mean over the runs, or over their pairs."""
    spread_pct: float | None
    """Std between the runs, averaged over the road (eq. 5.14; tables 5.1 and 5.2); null for one."""
    mean_grade_pct: Figures | None
    """Errors of the runs' average (eq. 5.15)."""


class Resolution(msgspec.Struct, frozen=True, kw_only=True):
    """The map of single runs in bins of one length, read at every metre (papers/004, 5.5)."""

    bin_m: float
    grade_pct: Figures | None
    """Errors against the truth; null without one."""
    differs_pct: Figures | None
    """From the shortest bins."""


class MassFound(msgspec.Struct, frozen=True, kw_only=True):
    """What fusion took a vehicle to weigh at the end of a run; null without torque."""

    stated_kg: float
    found_kg: float | None
    std_kg: float | None
    true_kg: float | None
    """Of a simulated drive."""


class SlopeReport(msgspec.Struct, frozen=True, kw_only=True):
    """What `wayline evaluate slope --json` writes."""

    runs: tuple[str, ...]
    points: int
    """SPACING_M apart, those that every run passed."""
    ways: dict[str, SlopeAccuracy]
    """By name: gps, barometer, torque (the single-sensor filters of papers/004); fusion (live grade
    by all sensors), live_gps, live_barometer, live_torque, live_vehicle (by one alone); map,
    map_gps and so on (single runs as the map learns them); yardstick."""
    against: Against = "truth"
    resolutions: tuple[Resolution, ...] = ()
    masses: tuple[MassFound, ...] = ()


@dataclass(frozen=True, slots=True)
class Grades:
    """Of one run by one way, over time, shape (n,)."""

    times_s: Floats
    grades_pct: Floats
    shift_s: float = 0.0
    stds_pct: Floats | None = None
    """One sigma where one is claimed."""


@dataclass(frozen=True, slots=True)
class Profiles:
    """Every run's grades at the same points of a road."""

    distances_m: Floats
    true_pct: Floats
    """Shape (points,): the runs' mean, which differ by less than a lane; nan where unknown."""
    ways: Mapping[str, Floats]
    """Shape (runs, points) each, nan where unknown."""
    stds: Mapping[str, Floats]
    """One sigma of these, nan where none is claimed."""
    against: Against = "truth"


def profiles_of(truths: Sequence[Reference], runs: Sequence[Mapping[str, Grades]]) -> Profiles:
    """Resample over the true distance from the start, which the runs of one road share."""
    end_m = min(float(truth.distances_m[-1]) for truth in truths)
    distances_m = np.arange(SPACING_M, end_m, SPACING_M)
    passed_s = [_passed_s(truth, distances_m) for truth in truths]
    true_pct = [
        np.interp(times_s, truth.times_s, truth.grades_pct, left=np.nan, right=np.nan)
        for truth, times_s in zip(truths, passed_s, strict=True)
    ]
    return profiles_at(distances_m, passed_s, runs, np.mean(true_pct, axis=0), "truth")


def profiles_at(
    distances_m: Floats,
    passed_s: Sequence[Floats],
    runs: Sequence[Mapping[str, Grades]],
    true_pct: Floats,
    against: Against,
) -> Profiles:
    """The ways that all runs have, at points of the road that each passed at such instants."""
    names = [name for name in runs[0] if all(name in run for run in runs)]
    ways, stds = {}, {}
    for name in names:
        read = [_read(run[name], times_s) for run, times_s in zip(runs, passed_s, strict=True)]
        ways[name] = np.array([grades_pct for grades_pct, _ in read])
        stds[name] = np.array([stds_pct for _, stds_pct in read])
    return Profiles(distances_m, true_pct, ways, stds, against)


def slope_report(
    names: Sequence[str],
    profiles: Profiles,
    shifts_s: Mapping[str, float],
    resolutions: Sequence[Resolution] = (),
    masses: Sequence[MassFound] = (),
) -> SlopeReport:
    """Sum up the runs."""
    return SlopeReport(
        runs=tuple(names),
        points=len(profiles.distances_m),
        against=profiles.against,
        ways={way: _accuracy(profiles, way, shifts_s[way]) for way in profiles.ways},
        resolutions=tuple(resolutions),
        masses=tuple(masses),
    )


def average_std(grades_pct: Floats) -> float | None:
    """Mean over the road of the std between runs (eq. 5.14); shape (runs, points)."""
    if len(grades_pct) < 2:
        return None
    stds = np.std(grades_pct, axis=0, ddof=1)
    return float(np.nanmean(stds)) if np.isfinite(stds).any() else None


def _accuracy(profiles: Profiles, way: str, shift_s: float) -> SlopeAccuracy:
    grades, stds = profiles.ways[way], profiles.stds[way]
    has_truth = profiles.against != "each other"
    if has_truth:
        pairs = [(run, profiles.true_pct) for run in grades]
        claimed = stds
    else:
        pairs = list(combinations(grades, 2))
        claimed = np.array([np.hypot(one, other) for one, other in combinations(stds, 2)])
    errors = np.array([run - other for run, other in pairs]).reshape(len(pairs), -1)
    average = np.mean(grades, axis=0) - profiles.true_pct
    return SlopeAccuracy(
        shift_s=shift_s,
        grade_pct=figures_of(errors.ravel()),
        mean_pct=_mean(errors.ravel().tolist()) if has_truth else None,
        inside_share=_inside_share(errors, claimed),
        correlation=_mean([correlation_of(run, other) for run, other in pairs]),
        hills_shift_m=_mean([hills_shift_m(profiles.distances_m, *pair) for pair in pairs]),
        spread_pct=average_std(grades),
        mean_grade_pct=figures_of(average),
    )


def _mean(values: Sequence[float | None]) -> float | None:
    known = [value for value in values if value is not None and np.isfinite(value)]
    return float(np.mean(known)) if known else None


def _inside_share(errors_pct: Floats, stds_pct: Floats) -> float | None:
    known = np.isfinite(errors_pct) & np.isfinite(stds_pct)
    if not known.any():
        return None
    return float(np.mean(np.abs(errors_pct[known]) < stds_pct[known]))


def _passed_s(truth: Reference, distances_m: Floats) -> Floats:
    """When the truth was at distances along the road."""
    moved = np.diff(truth.distances_m, prepend=-1.0) > 0.0
    return np.interp(distances_m, truth.distances_m[moved], truth.times_s[moved])


def _read(grades: Grades, passed_s: Floats) -> tuple[Floats, Floats]:
    """Grades and their stds at instants; nan before the first and after the last."""
    times_s = grades.times_s - grades.shift_s
    columns = grades.grades_pct, grades.stds_pct
    unknown = np.full(len(passed_s), np.nan)
    read = [
        unknown if each is None else np.interp(passed_s, times_s, each, left=np.nan, right=np.nan)
        for each in columns
    ]
    return read[0], read[1]
