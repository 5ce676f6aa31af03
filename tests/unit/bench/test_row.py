"""The arithmetic of a bench and its table; no speed is asserted."""

import pytest

from wayline_bench.row import compared, table


def test_a_ratio_is_the_median_of_the_rounds_own_ratios() -> None:
    """A round in which the whole machine was slow counts as one round."""
    row = compared("x", [2.0, 2.2, 40.0], [1.0, 1.0, 20.0], "y", unit="us")
    assert (row.ratio, row.ratio_low, row.ratio_high) == pytest.approx((2.0, 2.0, 2.1))
    assert (row.ours, row.yardstick) == (2.2, 1.0)


def test_a_bar_holds_up_to_itself() -> None:
    """And what has no bar always holds."""
    assert compared("x", [1.5], [1.0], "y", bar=1.5).holds
    assert not compared("x", [1.6], [1.0], "y", bar=1.5).holds
    assert compared("x", [99.0], [1.0], "y").holds


def test_a_table_is_aligned_markdown_that_tells_missed_bars() -> None:
    """Every line is as long as the others, large numbers are written out."""
    met = compared("short", [1.0], [1.0], "bare", unit="ms", bar=2.0)
    missed = compared("much longer", [4000.0], [1.0], "bare", unit="ms", bar=2.0)
    lines = table([met, missed]).splitlines()
    assert len({len(line) for line in lines}) == 1
    assert lines[0].startswith("| what        | ours    | yardstick |")
    assert "| 1 ms    | 1 ms bare | 1.00 (1.00 to 1.00)          | 2 met" in lines[2]
    assert "| 4000 ms | 1 ms bare | 4000.00 (4000.00 to 4000.00) | 2 MISSED |" in lines[3]


def test_a_small_share_is_not_rounded_away() -> None:
    """Two losses in ten thousand are not none."""
    assert "0.0002 (0.0002 to 0.0002)" in table([compared("x", [2.0], [10_000.0], "sent")])
