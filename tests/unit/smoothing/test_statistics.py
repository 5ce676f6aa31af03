"""Equations 17 to 19, t tests and the chi-square of table 4."""

import csv
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from scipy import stats

from wayline_evaluation.smoothing.modified_kalman import MILE_M
from wayline_evaluation.smoothing.printed import PRINTED
from wayline_evaluation.smoothing.statistics import (
    Sums,
    chi_square,
    figures_of_errors,
    paired_t,
    sums_of,
    trips_by_mile,
)

ERRORS = np.random.default_rng(3).normal(0.2, 1.5, 400)


def test_sums_of_parts_are_those_of_the_whole() -> None:
    parts = sums_of(ERRORS[:150]).plus(sums_of(np.append(ERRORS[150:], np.nan)))
    figures = figures_of_errors(parts)
    assert figures is not None
    assert figures.count == 400
    assert figures.mean == pytest.approx(ERRORS.mean())
    assert figures.variance == pytest.approx(ERRORS.var(ddof=1))
    assert figures.mean_absolute == pytest.approx(np.abs(ERRORS).mean())


def test_nothing_has_no_figures() -> None:
    assert figures_of_errors(Sums()) is None


def test_a_paired_t_test_is_scipys() -> None:
    other = np.random.default_rng(4).normal(0.3, 1.5, 400)
    wanted = stats.ttest_rel(ERRORS, other)
    tested = paired_t(sums_of(ERRORS - other))
    assert tested.t == pytest.approx(wanted.statistic)
    assert tested.p_value == pytest.approx(wanted.pvalue)
    assert tested.equal_means == (wanted.pvalue >= 0.05)


@pytest.mark.parametrize(("difference", "equal"), [(0.0, True), (0.4, False)])
def test_where_all_pairs_differ_alike_there_is_no_p(difference: float, *, equal: bool) -> None:
    tested = paired_t(sums_of(np.full(50, difference)))
    assert (tested.t, tested.p_value, tested.equal_means) == (None, None, equal)


def test_trips_are_counted_by_miles_the_last_class_open() -> None:
    counts = trips_by_mile([0.0, 0.99 * MILE_M, 1.0 * MILE_M + 0.1, 39.5 * MILE_M, 3e6])
    assert (counts[0], counts[1], counts[39], counts[40]) == (2, 1, 1, 1)
    assert len(counts) == 41


def test_table_4_has_the_papers_chi_square(recorded: Callable[[str], Path]) -> None:
    path = recorded("papers") / "smoothing-trip-length-contingency.csv"
    with path.open(newline="") as file:
        rows = list(csv.DictReader(file))
    reference = [int(row["vss_trips"]) for row in rows]
    for name, printed in PRINTED.items():
        found = chi_square(reference, [int(row[f"{name}_trips"]) for row in rows])
        assert found.chi2 == pytest.approx(printed.chi2, abs=0.005)
        assert found.critical == pytest.approx(55.76, abs=0.005)
        assert found.homogeneous == (name == "modified_kalman")
