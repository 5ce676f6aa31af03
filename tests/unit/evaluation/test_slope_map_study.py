"""The map beside the truth: only bins of the same way count."""

import numpy as np
import pytest

from wayline_evaluation.reference import true_reference
from wayline_evaluation.slope_map_study import map_accuracy
from wayline_slope_map.export import ExportRow

METRES_A_DEGREE = 111_000.0


def row(
    metres: float, *, grade_pct: float, heading_deg: float = 0.0, flagged: int = 0
) -> ExportRow:
    """A bin so far north of the begin."""
    lat_deg = 56.0 + metres / METRES_A_DEGREE
    place = ("road", metres, lat_deg, 10.0, heading_deg)
    return ExportRow(*place, grade_pct, 0.2, None, 1, "", flagged)


def test_bins_of_another_road_or_direction_do_not_count() -> None:
    times_s = np.arange(100.0)
    known = np.full(100, 2.0)
    truth = true_reference(
        times_s,
        56.0 + 10.0 * times_s / METRES_A_DEGREE,
        np.full(100, 10.0),
        alts_m=known,
        headings_deg=np.zeros(100),
        speeds_mps=np.full(100, 10.0),
        grades_pct=known,
    )
    rows = [
        row(100.0, grade_pct=2.1),
        row(200.0, grade_pct=2.3, flagged=1),
        row(300.0, grade_pct=-2.0, heading_deg=180.0),
        row(5000.0, grade_pct=9.0),
    ]
    found = map_accuracy(rows, truth, 1)
    assert (found.bins, found.flagged_bins) == (2, 1)
    assert found.rms_pct == pytest.approx(np.sqrt((0.01 + 0.09) / 2.0))
    assert found.mean_pct == pytest.approx(0.2)
    assert found.inside_share == 0.5
