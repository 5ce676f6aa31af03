"""Pure: grade of several runs of one road: against the truth, and run against run."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import msgspec
import numpy as np

from wayline_evaluation.estimates import Floats
from wayline_evaluation.figures import Figures, figures_of
from wayline_evaluation.reference import Reference

SPACING_M = 20.0
"""Between the points at which runs are compared: enough for main roads (papers/004, 5.5)."""


class SlopeAccuracy(msgspec.Struct, frozen=True, kw_only=True):
    """Of one way to know the grade."""

    shift_s: float
    """By which it was moved back in time before it was compared, as papers/004 does."""
    grade_pct: Figures | None
    """Errors against the truth, all runs pooled."""
    spread_pct: float | None
    """Std between the runs, averaged over the road (eq. 5.14); null for one run."""
    mean_grade_pct: Figures | None
    """Errors of the runs' average (eq. 5.15)."""


class SlopeReport(msgspec.Struct, frozen=True, kw_only=True):
    """What `wayline evaluate slope --json` writes."""

    runs: tuple[str, ...]
    points: int
    """SPACING_M apart, those that every run passed."""
    ways: dict[str, SlopeAccuracy]
    """By name: gps, barometer, torque (the single-sensor filters of papers/004), fusion,
    yardstick."""


@dataclass(frozen=True, slots=True)
class Grades:
    """Of one run by one way, over time, shape (n,)."""

    times_s: Floats
    grades_pct: Floats
    shift_s: float


@dataclass(frozen=True, slots=True)
class Profiles:
    """Every run's grades at the same points of a road."""

    distances_m: Floats
    true_pct: Floats
    """Shape (points,): the runs' mean, which differ by less than a lane."""
    ways: Mapping[str, Floats]
    """Shape (runs, points) each, nan where unknown."""


def profiles_of(truths: Sequence[Reference], runs: Sequence[Mapping[str, Grades]]) -> Profiles:
    """Resample over the true distance from the start, which the runs of one road share."""
    end_m = min(float(truth.distances_m[-1]) for truth in truths)
    distances_m = np.arange(SPACING_M, end_m, SPACING_M)
    names = [name for name in runs[0] if all(name in run for run in runs)]
    true_pct = [_at(truth, truth.times_s, truth.grades_pct, distances_m) for truth in truths]
    ways = {
        name: np.array(
            [
                _at(truth, run[name].times_s - run[name].shift_s, run[name].grades_pct, distances_m)
                for truth, run in zip(truths, runs, strict=True)
            ]
        )
        for name in names
    }
    return Profiles(distances_m, np.mean(true_pct, axis=0), ways)


def slope_report(
    names: Sequence[str], profiles: Profiles, shifts_s: Mapping[str, float]
) -> SlopeReport:
    """Sum up the runs."""
    return SlopeReport(
        runs=tuple(names),
        points=len(profiles.distances_m),
        ways={
            way: SlopeAccuracy(
                shift_s=shifts_s[way],
                grade_pct=figures_of((grades - profiles.true_pct).ravel()),
                spread_pct=average_std(grades),
                mean_grade_pct=figures_of(np.mean(grades, axis=0) - profiles.true_pct),
            )
            for way, grades in profiles.ways.items()
        },
    )


def average_std(grades_pct: Floats) -> float | None:
    """Mean over the road of the std between runs (eq. 5.14); shape (runs, points)."""
    if len(grades_pct) < 2:
        return None
    stds = np.std(grades_pct, axis=0, ddof=1)
    return float(np.nanmean(stds)) if np.isfinite(stds).any() else None


def _at(truth: Reference, times_s: Floats, grades_pct: Floats, distances_m: Floats) -> Floats:
    """Grades at distances along the road, which is where the truth was at their instants."""
    moved = np.diff(truth.distances_m, prepend=-1.0) > 0.0
    passed_s = np.interp(distances_m, truth.distances_m[moved], truth.times_s[moved])
    return np.interp(passed_s, times_s, grades_pct, left=np.nan, right=np.nan)
