"""Pure: the statistics of papers/003, equations 17 to 19, its t tests and its chi-square.

Of millions of samples sums are kept, trip by trip: memory does not grow with the trips.
"""

from collections.abc import Sequence
from typing import NamedTuple

import msgspec
import numpy as np
from scipy import stats

from wayline_evaluation.estimates import Floats
from wayline_evaluation.smoothing.modified_kalman import MILE_M

SIGNIFICANCE = 0.05
CLASSES = 41
"""One a mile, the last without an upper bound (table 4)."""
DEGREES_OF_FREEDOM = CLASSES - 1


class Sums(NamedTuple):
    """Of errors, or of what two series differ by; nan among them is left out."""

    number: int = 0
    total: float = 0.0
    squares: float = 0.0
    absolutes: float = 0.0

    def plus(self, other: "Sums") -> "Sums":
        """Both together."""
        return Sums(
            self.number + other.number,
            self.total + other.total,
            self.squares + other.squares,
            self.absolutes + other.absolutes,
        )


def sums_of(errors: Floats) -> Sums:
    """What is kept of errors."""
    known = errors[~np.isnan(errors)]
    return Sums(len(known), float(known.sum()), float(known @ known), float(np.abs(known).sum()))


class ErrorFigures(msgspec.Struct, frozen=True, kw_only=True):
    """Errors as reference minus method; the unit is in the name of what holds this."""

    count: int
    mean: float
    """ME (equation 17)."""
    variance: float
    """VE (equation 18), of the unit's square."""
    mean_absolute: float
    """MAE (equation 19)."""


def figures_of_errors(sums: Sums) -> ErrorFigures | None:
    """None without an error."""
    if sums.number == 0:
        return None
    mean = sums.total / sums.number
    return ErrorFigures(
        count=sums.number,
        mean=mean,
        variance=_variance(sums),
        mean_absolute=sums.absolutes / sums.number,
    )


def _variance(sums: Sums) -> float:
    if sums.number < 2:
        return 0.0
    return max(sums.squares - sums.total**2 / sums.number, 0.0) / (sums.number - 1)


class Tested(msgspec.Struct, frozen=True, kw_only=True):
    """A paired t test of equal means, two-sided."""

    count: int
    t: float | None
    """Null where all pairs differ by the same, or there are less than two."""
    p_value: float | None
    equal_means: bool
    """Not rejected at 5 %."""


def paired_t(differences: Sums) -> Tested:
    """Of two series, by what each pair differs by."""
    count, variance = differences.number, _variance(differences)
    mean = differences.total / count if count else 0.0
    if count < 2 or variance <= 1e-12 * mean * mean or variance == 0.0:
        return Tested(count=count, t=None, p_value=None, equal_means=mean == 0.0)
    t = mean / (variance / count) ** 0.5
    p_value = float(2.0 * stats.t.sf(abs(t), count - 1))
    return Tested(count=count, t=t, p_value=p_value, equal_means=p_value >= SIGNIFICANCE)


class ChiSquare(msgspec.Struct, frozen=True, kw_only=True):
    """Whether trips by a method spread over distances as those of the reference (table 4)."""

    trips: tuple[int, ...]
    """In each class of a mile."""
    cells: tuple[float, ...]
    chi2: float
    degrees_of_freedom: int
    critical: float
    """At 5 %."""
    p_value: float
    homogeneous: bool


def trips_by_mile(distances_m: Sequence[float]) -> tuple[int, ...]:
    """In 41 classes, the last without an upper bound."""
    miles = np.floor(np.array(distances_m) / MILE_M).astype(int)
    counts = np.bincount(np.clip(miles, 0, CLASSES - 1), minlength=CLASSES)
    return tuple(int(count) for count in counts)


def chi_square(reference: Sequence[int], trips: Sequence[int]) -> ChiSquare:
    """By cells of (VSS - x)^2 / (VSS + x), 0 where nothing is in either."""
    expected, seen = np.array(reference, dtype=float), np.array(trips, dtype=float)
    together = expected + seen
    cells = np.divide(
        np.square(expected - seen), together, out=np.zeros_like(together), where=together > 0.0
    )
    chi2, critical = float(cells.sum()), float(stats.chi2.isf(SIGNIFICANCE, DEGREES_OF_FREEDOM))
    return ChiSquare(
        trips=tuple(trips),
        cells=tuple(cells.tolist()),
        chi2=chi2,
        degrees_of_freedom=DEGREES_OF_FREEDOM,
        critical=critical,
        p_value=float(stats.chi2.sf(chi2, DEGREES_OF_FREEDOM)),
        homogeneous=chi2 <= critical,
    )
