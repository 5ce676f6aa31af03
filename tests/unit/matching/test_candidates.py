"""Every place of a line where a vehicle may be."""

import pytest

from unit.eta.route_drives import SPUR, SQUARE, TOWN, Metres, line_of
from wayline.matching.candidates import locally_nearest


@pytest.mark.parametrize(
    ("points_m", "seen_m", "alongs_m"),
    [
        ([(0, 0), (100, 0), (200, 0)], (50, 7), [50.0]),
        ([(0, 0), (100, 0), (200, 0)], (-9, 0), [0.0]),  # before the start
        ([(0, 0), (100, 0), (200, 0)], (220, 0), [200.0]),  # beyond the end
        ([(0, 0), (100, 0), (100, 100)], (110, -10), [100.0]),  # outside a corner
        ([(0, 0), (100, 0), (100, 100)], (95, 10), [95.0, 110.0]),  # inside it
        (SPUR, (1005, 300), [1300.0, 1500.0]),  # there and back on the same ground
        (SPUR, (1000, 400), [1400.0]),  # its tip
        (SQUARE, (-3, -4), [0.0, 2000.0]),  # where a loop begins and ends
    ],
)
def test_each_passage_has_its_place(
    points_m: list[Metres], seen_m: Metres, alongs_m: list[float]
) -> None:
    found = locally_nearest(line_of(points_m), *TOWN.to_geodetic(*seen_m))
    assert [each.along_m for each in found] == pytest.approx(alongs_m, abs=0.1)


def test_the_offset_is_positive_to_the_right() -> None:
    line = line_of([(0, 0), (100, 0), (0, 0)])
    found = locally_nearest(line, *TOWN.to_geodetic(40.0, -6.0))
    assert [each.offset_m for each in found] == pytest.approx([6.0, -6.0], abs=0.01)
    assert [each.heading_deg for each in found] == pytest.approx([90.0, 270.0], abs=0.1)


def test_far_passages_are_left_out() -> None:
    line = line_of([(0, 0), (1000, 0), (1000, 300), (0, 300)])
    found = locally_nearest(line, *TOWN.to_geodetic(500.0, 10.0))
    assert [each.along_m for each in found] == pytest.approx([500.0], abs=0.1)


@pytest.mark.parametrize(("apart_m", "passages"), [(160.0, 2), (240.0, 1)])
def test_a_passage_counts_within_200_m_of_the_nearest(apart_m: float, passages: int) -> None:
    line = line_of([(0, 0), (1000, 0), (1000, apart_m), (0, apart_m)])
    found = locally_nearest(line, *TOWN.to_geodetic(500.0, 0.0))
    assert len(found) == passages
