"""A bin's whole-number sums say what the runs said, in any order."""

import itertools
import statistics

import pytest

from wayline_slope_map.sums import BinSums, estimate, run_sums


def added(*runs: BinSums) -> BinSums:
    totals = BinSums(*(sum(column) for column in zip(*runs, strict=True)))
    return totals._replace(updated_ns=max(run.updated_ns for run in runs))


def test_a_single_run_reads_back_as_it_was() -> None:
    known = estimate(run_sums(-3.217, 0.84, 143.62, 3.9, 1_700_000_000_000_000_000))
    assert known.grade_pct == pytest.approx(-3.217, abs=1e-5)
    assert known.grade_std_pct == pytest.approx(0.84, abs=1e-5)
    assert known.alt_m == pytest.approx(143.62, abs=1e-4)
    assert known.spread_pct is None
    assert (known.runs, known.updated_ns) == (1, 1_700_000_000_000_000_000)


def test_merging_gives_the_same_last_digit_in_any_order() -> None:
    runs = [run_sums(0.1 * k, 0.3 + 0.07 * k, 99.9 - k / 3, 2.0 + k, k) for k in range(1, 6)]
    assert len({added(*order) for order in itertools.permutations(runs)}) == 1


def test_spread_of_equally_good_runs_is_their_sample_standard_deviation() -> None:
    grades_pct = [2.0, 2.3, 1.6, 2.4]
    known = estimate(added(*(run_sums(g, 0.5, 100.0, 3.0, 1) for g in grades_pct)))
    assert known.spread_pct == pytest.approx(statistics.stdev(grades_pct), rel=1e-5)
    assert known.grade_pct == pytest.approx(statistics.mean(grades_pct), rel=1e-5)


def test_a_better_run_weighs_more() -> None:
    known = estimate(added(run_sums(1.0, 0.5, 90.0, 2.0, 1), run_sums(2.0, 1.0, 100.0, 4.0, 2)))
    assert known.grade_pct == pytest.approx(1.2)
    assert known.alt_m == pytest.approx(92.0)


def test_agreeing_runs_make_the_grade_surer_but_never_certain() -> None:
    stds = [
        estimate(added(*(run_sums(1.0, 0.6, 90.0, 2.0, 1) for _ in range(runs)))).grade_std_pct
        for runs in (1, 2, 6, 1000)
    ]
    assert stds == sorted(stds, reverse=True)
    assert 0.6 * 0.7 < stds[-1] < 0.6 * 0.75


def test_runs_that_contradict_each_other_make_it_less_sure() -> None:
    agreeing = estimate(added(*(run_sums(1.0, 0.3, 90.0, 2.0, 1) for _ in range(4))))
    apart = estimate(added(*(run_sums(g, 0.3, 90.0, 2.0, 1) for g in (-1.0, 3.0, -1.0, 3.0))))
    assert apart.grade_pct == pytest.approx(agreeing.grade_pct, abs=1e-5)
    assert apart.grade_std_pct > 5.0 * agreeing.grade_std_pct


def test_a_million_steep_runs_fit_into_a_database_column() -> None:
    extreme = run_sums(50.0, 0.0, 9000.0, 0.0, 1)
    assert all(abs(value) * 1_000_000 < 2**63 for value in extreme[1:-1])
