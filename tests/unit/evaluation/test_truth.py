from pathlib import Path

import numpy as np
import pytest

from wayline.errors import InputError
from wayline_evaluation.truth import read_truth

HEADER = "t_s,lat_deg,lon_deg,alt_m,heading_deg,speed_mps,grade_pct\n"


def written(folder: Path, text: str) -> Path:
    path = folder / "truth.csv"
    path.write_text(text, encoding="utf-8")
    return path


def test_headings_are_interpolated_the_short_way_round(tmp_path: Path) -> None:
    """Between 350 and 10 degrees lies north, not south."""
    rows = "0,56,10,1,350,0,0\n1,56,10.001,3,10,0,0\n"
    between = read_truth(written(tmp_path, HEADER + rows)).at(np.array([0.25, 0.5, 0.75]))
    assert between.headings_deg == pytest.approx([355.0, 0.0, 5.0], abs=0.1)
    assert between.alts_m == pytest.approx([1.5, 2.0, 2.5])


def test_nothing_is_known_outside_the_truth(tmp_path: Path) -> None:
    """Poses before its first row and after its last are not scored."""
    truth = read_truth(written(tmp_path, HEADER + "0,56,10,1,0,0,0\n1,56,10,1,0,0,0\n"))
    assert np.isnan(truth.at(np.array([-0.1, 1.1])).lats_deg).all()


def test_columns_and_cells_may_be_missing(tmp_path: Path) -> None:
    """Then the quantity is unknown, and directions are those of the track."""
    rows = "0,56.0,10,5\n1,56.001,10,\n2,56.002,10,7\n"
    truth = read_truth(written(tmp_path, "t_s,lat_deg,lon_deg,alt_m\n" + rows))
    assert np.isnan(truth.headings_deg).all()
    assert list(np.isnan(truth.alts_m)) == [False, True, False]
    assert truth.directions_deg == pytest.approx([0.0, 0.0, 0.0], abs=1e-6)
    assert truth.distances_m[-1] == pytest.approx(222.7, abs=0.1)


def test_columns_of_words_are_passed_over(tmp_path: Path) -> None:
    """Such as the trip of a timetable, in any place."""
    rows = "0,A0,56.0,10,5\n1,A0,56.001,10,\n"
    truth = read_truth(written(tmp_path, "t_s,trip_id,lat_deg,lon_deg,distance_m\n" + rows))
    assert truth.lats_deg == pytest.approx([56.0, 56.001])


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("t_s,lat_deg\n0,1\n1,1\n", "no column lon_deg"),
        ("t_s,lat_deg,lon_deg\n0,1,x\n1,1,1\n", "write numbers"),
        ("t_s,lat_deg,lon_deg\n0,1,1\n1,1\n", "write numbers"),
        ("t_s,lat_deg,lon_deg\n1,1,1\n1,1,1\n", "does not increase"),
        ("t_s,lat_deg,lon_deg\n1,1,1\n", "too few rows"),
    ],
)
def test_a_bad_truth_is_one_clear_error(tmp_path: Path, text: str, says: str) -> None:
    """It names what is wrong."""
    with pytest.raises(InputError, match=says):
        read_truth(written(tmp_path, text))
