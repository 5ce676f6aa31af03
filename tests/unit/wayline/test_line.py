"""Distances along a line, and the nearest point of it."""

import numpy as np
import pytest

from wayline.geo import LocalPlane
from wayline.line import Line

PLANE = LocalPlane(59.2, 17.6)


def line_of(*points_m: tuple[float, float]) -> Line:
    places = np.array([PLANE.to_geodetic(*point_m) for point_m in points_m])
    return Line(places[:, 0], places[:, 1])


NORTH_THEN_EAST = line_of((0, 0), (0, 300), (400, 300))


def test_distances_grow_along_the_geodesics() -> None:
    assert NORTH_THEN_EAST.distances_m == pytest.approx([0.0, 300.0, 700.0], abs=1e-3)
    assert NORTH_THEN_EAST.headings_deg == pytest.approx([0.0, 90.0], abs=0.02)


def test_one_point_is_no_line() -> None:
    with pytest.raises(ValueError, match="two or more"):
        Line(np.array([59.0]), np.array([17.0]))


@pytest.mark.parametrize(
    ("distance_m", "east_m", "north_m"),
    [(-5.0, 0, 0), (120.0, 0, 120), (300.0, 0, 300), (500.0, 200, 300), (900.0, 400, 300)],
)
def test_a_point_at_a_distance_is_clipped_to_the_line(
    distance_m: float, east_m: float, north_m: float
) -> None:
    lat_deg, lon_deg, _ = NORTH_THEN_EAST.point_at(distance_m)
    assert PLANE.to_plane(lat_deg, lon_deg) == pytest.approx((east_m, north_m), abs=0.01)


@pytest.mark.parametrize(
    ("seen_m", "along_m", "cross_track_m"),
    [
        ((20, 100), 100.0, 20.0),  # east of a northward leg is right
        ((-20, 100), 100.0, -20.0),
        ((150, 310), 450.0, -10.0),  # north of an eastward leg is left
        ((430, 340), 700.0, -50.0),  # beyond the end
    ],
)
def test_cross_track_is_positive_to_the_right(
    seen_m: tuple[float, float], along_m: float, cross_track_m: float
) -> None:
    found = NORTH_THEN_EAST.project(*PLANE.to_geodetic(*seen_m))
    assert found is not None
    assert found.distance_m == pytest.approx(along_m, abs=0.05)
    assert found.cross_track_m == pytest.approx(cross_track_m, abs=0.05)


def test_heading_chooses_between_there_and_back() -> None:
    out_and_back = line_of((0, 0), (0, 300), (0, 0))
    seen = PLANE.to_geodetic(1.0, 100.0)
    there = out_and_back.project(*seen, heading_deg=5.0)
    back = out_and_back.project(*seen, heading_deg=175.0)
    assert there is not None
    assert back is not None
    assert (there.distance_m, back.distance_m) == pytest.approx((100.0, 500.0), abs=0.05)
    assert out_and_back.project(*seen, heading_deg=90.0, heading_tolerance_deg=60.0) is None


def test_a_stretch_limits_where_the_nearest_point_may_be() -> None:
    seen = PLANE.to_geodetic(0.0, 100.0)
    within = NORTH_THEN_EAST.project(*seen, from_m=150.0, to_m=250.0)
    assert within is not None
    assert within.distance_m == pytest.approx(150.0, abs=0.05)
    assert abs(within.cross_track_m) == pytest.approx(50.0, abs=0.05)


def test_the_date_line_is_no_edge() -> None:
    line = Line(np.array([10.0, 10.0]), np.array([179.999, -179.999]))
    found = line.project(10.0001, -179.9995)
    assert line.length_m == pytest.approx(219.3, abs=0.5)
    assert found is not None
    assert found.distance_m == pytest.approx(164.5, abs=0.5)
