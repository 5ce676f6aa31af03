"""Pure: the whole-number sums of a bin, and what they say.

Whole numbers, because their addition is commutative and associative to the last digit. A run's
weight comes from the run alone.
"""

import math
from typing import NamedTuple

from wayline_slope_map.judging import COMMON_SHARE

WEIGHT_SCALE = 1_000_000
"""Weights are kept in millionths: fine enough for one run, and a million runs fit in 64 bits."""
GRADE_STD_FLOOR_PCT = 0.05
"""No run knows a grade better; also keeps the sums of a million runs inside 64 bits."""
ALT_STD_FLOOR_M = 0.1


class BinSums(NamedTuple):
    """Of one bin, direction and sensor; w = 1 / variance, scaled."""

    runs: int
    grade_weight: int
    grade_sum: int
    grade_square_sum: int
    alt_weight: int
    alt_sum: int
    updated_ns: int


class BinEstimate(NamedTuple):
    """What is known of a bin; the grade is positive uphill in the direction of travel."""

    grade_pct: float
    grade_std_pct: float
    spread_pct: float | None
    """Sample standard deviation between runs (papers/004 eq. 5.14); None of a single run."""
    alt_m: float | None
    runs: int
    """Those that the estimate is made of."""
    updated_ns: int
    flagged_runs: int = 0
    """Outliers, which it is not made of."""


def run_sums(
    grade_pct: float,
    grade_std_pct: float,
    alt_m: float | None,
    alt_std_m: float | None,
    t_ns: int,
) -> BinSums:
    """The sums of a single run."""
    # sums are of the rounded weights, so that a single run reads back as it was
    grade_weight = max(round(WEIGHT_SCALE / max(grade_std_pct, GRADE_STD_FLOOR_PCT) ** 2), 1)
    alt_weight = _alt_weight(alt_std_m)
    return BinSums(
        runs=1,
        grade_weight=grade_weight,
        grade_sum=round(grade_weight * grade_pct),
        grade_square_sum=round(grade_weight * grade_pct**2),
        alt_weight=alt_weight,
        alt_sum=round(alt_weight * (alt_m or 0.0)),
        updated_ns=t_ns,
    )


def _alt_weight(alt_std_m: float | None) -> int:
    if alt_std_m is None:
        return 0
    return max(round(WEIGHT_SCALE / max(alt_std_m, ALT_STD_FLOOR_M) ** 2), 1)


def without(sums: BinSums, run: BinSums) -> BinSums:
    """The sums as they were without a run; when they were last changed stays."""
    names = BinSums._fields[:-1]
    return sums._replace(**{name: getattr(sums, name) - getattr(run, name) for name in names})


def estimate(sums: BinSums, common_share: float = COMMON_SHARE, flagged: int = 0) -> BinEstimate:
    """Weighted mean grade and altitude, with an honest std of the grade.

    A smoother trades noise against lag behind the true slope, and at its optimum both give the
    same variance (a random-walk slope seen through white noise in its integral's rate: the two
    integrals of the error spectrum are equal). The noise averages out over runs, the lag does
    not: every run cuts the same crest. `common_share` is the lag's. If the runs differ by more
    than they claim, their std grows by that ratio (Birge).
    """
    mean_pct = sums.grade_sum / sums.grade_weight
    mean_variance = sums.runs * WEIGHT_SCALE / sums.grade_weight
    variance = mean_variance * (common_share + (1.0 - common_share) / sums.runs)
    chi_square = max((sums.grade_square_sum - sums.grade_sum * mean_pct) / WEIGHT_SCALE, 0.0)
    spread_pct = None
    if sums.runs > 1:
        ratio = chi_square / (sums.runs - 1)
        spread_pct = math.sqrt(ratio * mean_variance)
        variance *= max(1.0, ratio)
    return BinEstimate(
        grade_pct=mean_pct,
        grade_std_pct=math.sqrt(variance),
        spread_pct=spread_pct,
        alt_m=sums.alt_sum / sums.alt_weight if sums.alt_weight else None,
        runs=sums.runs,
        updated_ns=sums.updated_ns,
        flagged_runs=flagged,
    )
