"""How alike profiles of a road are: shift of hills, places without a truth, runs held together."""

from pathlib import Path

import numpy as np
import pytest

from wayline.errors import InputError
from wayline_evaluation.estimates import Estimates, Floats
from wayline_evaluation.slope import Grades, profiles_at, slope_report
from wayline_evaluation.slope_hills import correlation_of, hills_shift_m
from wayline_evaluation.slope_places import Places, nearest_to, passed_s, points_along
from wayline_evaluation.slope_reference import read_road

LAT_DEG, METRES_A_DEGREE = 56.0, 111_300.0
WAY_M = np.arange(0.0, 6000.0, 20.0)


def hills_pct(way_m: Floats) -> Floats:
    waves: Floats = 3.0 * np.sin(way_m / 150.0) + 2.0 * np.sin(way_m / 67.0)
    return waves


def northwards(speed_mps: float, *, start_m: float = 0.0, northward: bool = True) -> Estimates:
    """Along a meridian, ten poses a second."""
    times_s = np.arange(0.0, (6000.0 - start_m) / speed_mps, 0.1)
    way_m = speed_mps * times_s
    along_m = start_m + way_m if northward else 6000.0 - way_m
    count = len(times_s)
    filled = {
        name: np.zeros(count)
        for name in Estimates.__dataclass_fields__
        if name not in {"times_s", "dead_reckoning"}
    }
    filled |= {
        "lats_deg": LAT_DEG + along_m / METRES_A_DEGREE,
        "lons_deg": np.full(count, 10.0),
        "headings_deg": np.full(count, 0.0 if northward else 180.0),
        "speeds_mps": np.full(count, speed_mps),
        "distances_m": way_m,
    }
    return Estimates(
        times_s=1000.0 + times_s, dead_reckoning=np.zeros(count, dtype=np.bool_), **filled
    )


@pytest.mark.parametrize("late_m", [-37.0, 0.0, 12.5])
def test_a_profile_that_comes_late_is_found_late(late_m: float) -> None:
    shifted_pct = hills_pct(WAY_M - late_m)
    assert hills_shift_m(WAY_M, shifted_pct, hills_pct(WAY_M)) == pytest.approx(late_m, abs=1.0)


def test_an_even_road_has_no_hills_to_shift() -> None:
    assert hills_shift_m(WAY_M, np.zeros(len(WAY_M)), hills_pct(WAY_M)) is None
    assert correlation_of(np.zeros(len(WAY_M)), hills_pct(WAY_M)) is None


def test_runs_pass_the_same_points_though_they_start_elsewhere_and_drive_otherwise() -> None:
    distances_m, points = points_along(northwards(20.0), 20.0)
    times_s = passed_s(northwards(10.0, start_m=500.0), points)
    before = distances_m < 470.0
    assert np.isnan(times_s[before]).all()
    passed = distances_m > 510.0
    assert times_s[passed] == pytest.approx(1000.0 + (distances_m[passed] - 500.0) / 10.0, abs=0.2)


def test_the_way_back_is_another_road() -> None:
    _, points = points_along(northwards(20.0), 20.0)
    assert np.isnan(passed_s(northwards(20.0, northward=False), points)).all()


def test_places_without_headings_are_found_by_place_alone() -> None:
    _, points = points_along(northwards(20.0), 20.0)
    unknown = points._replace(headings_deg=np.full(len(points.lats_deg), np.nan))
    rows, is_near = nearest_to(points, unknown)
    assert is_near.all()
    assert rows.tolist() == list(range(len(rows)))


def test_without_a_truth_runs_are_held_against_each_other() -> None:
    """Two runs that differ by 0.2 % all along, and claim 0.3 % each."""
    runs = [
        {"map": Grades(WAY_M, hills_pct(WAY_M) + off_pct, stds_pct=np.full(len(WAY_M), 0.3))}
        for off_pct in (0.0, 0.2)
    ]
    unknown = np.full(len(WAY_M), np.nan)
    profiles = profiles_at(WAY_M, [WAY_M, WAY_M], runs, unknown, "each other")
    found = slope_report(["a", "b"], profiles, {"map": 0.0})
    way = found.ways["map"]
    assert found.against == "each other"
    assert way.grade_pct is not None
    assert way.grade_pct.rms == pytest.approx(0.2)
    assert (way.inside_share, way.mean_pct, way.mean_grade_pct) == (1.0, None, None)
    assert way.correlation == pytest.approx(1.0)
    assert way.hills_shift_m == pytest.approx(0.0, abs=0.1)
    assert way.spread_pct == pytest.approx(0.2 / np.sqrt(2.0))


def test_a_reference_is_read_by_place_and_heading(tmp_path: Path) -> None:
    """As `wayline slope export` writes one; what heads the other way is not this road."""
    path = tmp_path / "road.csv"
    path.write_text(
        "road_id,lat_deg,lon_deg,heading_deg,grade_pct\n"
        "a,56.0,10.0,0.0,2.5\n"
        "a,56.0,10.0,180.0,-2.5\n"
    )
    points = Places(np.array([56.0001, 56.1]), np.array([10.0, 10.0]), np.array([5.0, 5.0]))
    told = read_road(path).at(points)
    assert told[0] == 2.5
    assert np.isnan(told[1])


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("", "has no rows"),
        ("lat_deg,lon_deg\n1,2\n", "no column grade_pct"),
        ("lat_deg,lon_deg,grade_pct\n1,2,steep\n", "could not convert"),
    ],
)
def test_a_reference_that_is_none_is_refused(tmp_path: Path, text: str, told: str) -> None:
    path = tmp_path / "road.csv"
    path.write_text(text)
    with pytest.raises(InputError, match=told):
        read_road(path)
