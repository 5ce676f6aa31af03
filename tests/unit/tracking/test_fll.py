"""Equations 1 to 3 of papers/001."""

import csv
import math
import os
from pathlib import Path

import pytest

from wayline_evaluation.tracking.figures import family
from wayline_evaluation.tracking.fll import (
    Reading,
    allowed_bandwidth_hz,
    natural_radps,
    ratio_hz,
    stress_hz,
    thermal_jitter_hz,
    threshold_dbhz,
    threshold_hz,
    tracking_sigma_hz,
)


@pytest.mark.parametrize(("reading", "jitter"), [("inside", "1.0557"), ("outside", "1.1072")])
def test_equation_2_gives_the_tables_figures_to_all_their_digits(
    reading: Reading, jitter: str
) -> None:
    """T 0.01 s, F 1, 1 Hz, 30 dB-Hz."""
    assert f"{thermal_jitter_hz(1.0, ratio_hz(30.0), reading=reading):.4f}" == jitter


def test_the_papers_table_tells_the_same_figures() -> None:
    data = os.environ.get("WAYLINE_DATA")
    if data is None:
        pytest.skip("WAYLINE_DATA names no folder of recorded data")
    table = (Path(data) / "papers/gpsdr-formulas.csv").read_text(encoding="utf-8")
    rows = csv.DictReader(table.splitlines())
    note = next(row["note"] for row in rows if row["id"] == "fll_thermal")
    cn0_hz = ratio_hz(30.0)
    assert f"{thermal_jitter_hz(1.0, cn0_hz):.4f} Hz inside" in note
    assert f"{thermal_jitter_hz(1.0, cn0_hz, reading='outside'):.4f} Hz outside" in note


def test_near_the_threshold_jitter_is_a_root_of_two_larger() -> None:
    strong, weak = (thermal_jitter_hz(1.0, 100.0, factor=factor) for factor in (1.0, 2.0))
    assert weak == pytest.approx(strong * math.sqrt(2.0))


def test_figure_1_rises_with_bandwidth_and_falls_with_strength() -> None:
    curves = family()
    for one in curves:
        for other in curves:
            if (one.cn0_dbhz, one.bandwidth_hz) < (other.cn0_dbhz, one.bandwidth_hz):
                same_width = one.bandwidth_hz == other.bandwidth_hz
                assert not same_width or one.inside_hz > other.inside_hz
            if one.cn0_dbhz == other.cn0_dbhz and one.bandwidth_hz < other.bandwidth_hz:
                assert one.inside_hz < other.inside_hz
    assert all(one.inside_hz < one.outside_hz for one in curves)


def test_the_threshold_is_that_of_the_papers_integration() -> None:
    assert f"{threshold_hz(0.01):.2f}" == "8.33"


def test_stress_is_a_turn_of_jerk_over_the_natural_frequency_squared() -> None:
    """Equation 3: 360 deg/s3 are 1 Hz/s2."""
    assert stress_hz(360.0 * 5.0, 1.2) == pytest.approx(5.0 / natural_radps(1.2) ** 2)


def test_the_threshold_in_dbhz_is_where_equation_1_just_holds() -> None:
    level = threshold_dbhz(1.2, 3.0)
    assert level is not None
    jitter_hz = thermal_jitter_hz(1.2, ratio_hz(level))
    assert tracking_sigma_hz(jitter_hz, 3.0) == pytest.approx(threshold_hz())


def test_too_much_stress_has_no_threshold() -> None:
    assert threshold_dbhz(1.2, 26.0) is None


@pytest.mark.parametrize("left", [0.01, 0.1, 0.5])
def test_the_allowed_bandwidth_bears_what_the_aid_leaves_as_the_wide_one_bears_all(
    left: float,
) -> None:
    narrow_hz = allowed_bandwidth_hz(1.2, left)
    assert stress_hz(left, narrow_hz) == pytest.approx(stress_hz(1.0, 1.2))


def test_a_worthless_aid_widens_no_loop() -> None:
    assert allowed_bandwidth_hz(1.2, 3.0) == 1.2
