"""The published route filter beside what papers/000 prints of it."""

import math
from collections.abc import Callable
from pathlib import Path

import pytest

from unit.eta.route_drives import SQUARE, route_of
from wayline.errors import InputError
from wayline_eta.avl_filter import AvlRouteFilter
from wayline_evaluation.avl import Printed, Sample, avl_report, ellipse_of
from wayline_evaluation.avl_plot import plot_avl
from wayline_evaluation.avl_study import PLANNED, PRINTED, SAMPLES, avl_study
from wayline_evaluation.avl_table import avl_tables

ROUTE = route_of(SQUARE)
PLANNED_ROWS = "latitude_deg,longitude_deg,speed_m_s\n39.9,-75.35,10\n39.91,-75.35,10\n"


def test_the_printed_estimates_are_told_as_near_as_they_are(
    recorded: Callable[[str], Path], tmp_path: Path
) -> None:
    study = avl_study(recorded("papers"))
    report = study.report
    assert (report.rows, report.ends_at_row) == (187, 196)
    assert report.north.mean_m == pytest.approx(0.40, abs=0.01)
    assert report.flat.rms_m == pytest.approx(2.6, abs=0.05)
    assert report.flat.max_m == pytest.approx(6.4, abs=0.05)
    plot_avl(study, tmp_path / "avl.png")
    assert (tmp_path / "avl.png").stat().st_size > 10_000


def test_ellipses_lie_along_the_route_and_grow_with_every_row_without_a_fix(
    recorded: Callable[[str], Path],
) -> None:
    with_fix, *gaps = avl_study(recorded("papers")).report.gaps
    assert [gap.rows_without for gap in gaps] == [1, 2, 3]
    lengths_m = [with_fix.major_m, *(gap.major_m for gap in gaps)]
    assert lengths_m == sorted(lengths_m)
    assert gaps[-1].major_m > 1.9 * gaps[-1].minor_m
    assert all(gap.off_route_deg < 5.0 for gap in (with_fix, *gaps))


def test_an_ellipse_has_the_axes_of_the_covariance() -> None:
    filter_ = AvlRouteFilter(ROUTE)
    filter_.step((39.9, -75.35))
    estimate = filter_.step(None)
    assert estimate is not None
    # north along the square's first side: 15 of P and 10 of Q along it, the latter alone across
    ellipse = ellipse_of(estimate)
    assert ellipse.major_m == pytest.approx(5.0)
    assert ellipse.minor_m == pytest.approx(math.sqrt(10.0))
    assert min(ellipse.heading_deg, 180.0 - ellipse.heading_deg) == pytest.approx(0.0, abs=0.1)


def test_distances_are_north_and_east_of_what_is_printed() -> None:
    filter_ = AvlRouteFilter(ROUTE)
    samples = [Sample(39.9, -75.35, is_repeat=False)]
    estimates = [estimate for sample in samples if (estimate := filter_.step(sample[:2]))]
    report = avl_report(samples, estimates, [Printed(1, 39.9001, -75.35)])
    assert report.north.mean_m == pytest.approx(11.1, abs=0.1)
    assert report.east.max_m == pytest.approx(0.0, abs=0.1)
    assert [len(table.rows) for table in avl_tables(report)] == [3, 1]


@pytest.mark.parametrize(
    ("samples", "printed", "said"),
    [
        (None, None, "cannot be read"),
        ("latitude_deg,longitude_deg\n39.9,-75.35\n", "", "is no such table"),
        ("latitude_deg,longitude_deg,is_repeat\n", "", "is empty"),
        ("latitude_deg,longitude_deg,is_repeat\n39.9,-75.35,1\n", "1,39.9,-75.35", "begins with"),
        ("latitude_deg,longitude_deg,is_repeat\n39.9,-75.35,0\n", "7,39.9,-75.35", "not there"),
    ],
)
def test_a_folder_without_the_tables_is_one_line(
    tmp_path: Path, samples: str | None, printed: str | None, said: str
) -> None:
    (tmp_path / PLANNED).write_text(PLANNED_ROWS)
    if samples is not None:
        (tmp_path / SAMPLES).write_text(samples)
        head = "gps_row_inferred,latitude_deg,longitude_deg\n"
        (tmp_path / PRINTED).write_text(f"{head}{printed}\n")
    with pytest.raises(InputError, match=said):
        avl_study(tmp_path)
