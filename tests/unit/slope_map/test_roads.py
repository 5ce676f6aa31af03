"""Roads: their lines, their names, and which one a place lies on."""

import numpy as np
import pytest

from wayline.errors import InputError
from wayline.geo import metres_per_degree
from wayline.line import Floats, Line
from wayline.matching.matcher import Matcher
from wayline.matching.network import Candidate, Sight
from wayline.matching.transition import Moves
from wayline_slope_map.known_roads import KnownRoads
from wayline_slope_map.matching import CHANGE_COST, Match, RoadIndex
from wayline_slope_map.profile import RoadProfile
from wayline_slope_map.roads import Road, check_same_route, made_road, route_road, simplified

LAT_DEG, LON_DEG = 56.0, 10.0
NORTH_M, EAST_M = metres_per_degree(LAT_DEG)


def degrees(east_m: Floats, north_m: Floats) -> tuple[Floats, Floats]:
    return LAT_DEG + north_m / NORTH_M, LON_DEG + east_m / EAST_M


def straight(length_m: float = 500.0, beside_m: float = 0.0) -> tuple[Floats, Floats]:
    east_m = np.arange(0.0, length_m + 1.0, 10.0)
    return degrees(east_m, np.full(len(east_m), -beside_m))


def road(lats_deg: Floats, lons_deg: Floats) -> Road:
    return made_road(lats_deg, lons_deg, bin_m=20.0)[0]


def best(index: RoadIndex, east_m: float, north_m: float, heading_deg: float) -> Match | None:
    found = Matcher(index).observe(sight(east_m, north_m, heading_deg), Moves.measured(0.0))
    return Match.of(found.candidate) if found else None


def sight(east_m: float, north_m: float, heading_deg: float, second: float = 0.0) -> Sight:
    lat_deg, lon_deg = degrees(np.array(east_m), np.array(north_m))
    return Sight(round(second * 1e9), float(lat_deg), float(lon_deg), 3.0, heading_deg)


def test_a_line_keeps_every_point_within_its_tolerance_and_few_vertices() -> None:
    along_m = np.arange(0.0, 3000.0, 10.0)
    lats_deg, lons_deg = degrees(along_m, 200.0 * np.sin(along_m / 300.0))
    kept = simplified(lats_deg, lons_deg, 2.0)
    line = Line(lats_deg[kept], lons_deg[kept])
    nearest = [line.project(*at) for at in zip(lats_deg, lons_deg, strict=True)]
    away_m = max(abs(at.cross_track_m) for at in nearest if at is not None)
    assert 0.5 < away_m < 2.1
    assert len(kept) < len(along_m) / 5


def test_a_road_is_named_by_its_geometry_alone() -> None:
    assert road(*straight()).road_id == road(*straight()).road_id
    assert road(*straight()).road_id != road(*straight(510.0)).road_id


def test_a_road_that_runs_into_its_own_start_is_a_loop() -> None:
    turn = np.linspace(0.0, 2.0 * np.pi, 100)
    ring = road(*degrees(150.0 * np.sin(turn), 150.0 * np.cos(turn)))
    three_quarters = road(*degrees(150.0 * np.sin(turn[:75]), 150.0 * np.cos(turn[:75])))
    there_and_back = np.concatenate((np.arange(0.0, 500.0, 10.0), np.arange(500.0, -1.0, -10.0)))
    dead_end = road(*degrees(there_and_back, np.where(np.arange(101) > 50, 8.0, 0.0)))
    assert (ring.loop, three_quarters.loop, dead_end.loop) == (True, False, False)


def test_a_route_that_was_moved_is_refused_and_says_what_to_do() -> None:
    line = Line(*straight())
    stored = route_road(line, "7", loop=False, bin_m=20.0)
    check_same_route(stored, route_road(line, "7", loop=False, bin_m=20.0))
    moved = route_road(Line(*straight(beside_m=15.0)), "7", loop=False, bin_m=20.0)
    with pytest.raises(InputError, match=r"route 7: .* another route_id"):
        check_same_route(stored, moved)


def test_a_place_is_on_the_road_whose_way_it_goes() -> None:
    index = RoadIndex([road(*straight())])
    along = best(index, 203.0, 4.0, 95.0)
    against = best(index, 203.0, 4.0, 265.0)
    assert along is not None
    assert against is not None
    assert (along.direction, against.direction) == (1, -1)
    assert along.along_m == pytest.approx(203.0, abs=0.5)
    assert against.along_m == pytest.approx(203.0, abs=0.5)
    assert best(index, 203.0, 4.0, 180.0) is None


@pytest.mark.parametrize(("is_route", "reach_m"), [(False, 25.0), (True, 40.0)])
def test_a_route_reaches_further_than_a_road_and_one_way_only(
    is_route: bool, reach_m: float
) -> None:
    lats_deg, lons_deg = straight()
    made = route_road(Line(lats_deg, lons_deg), "7", loop=False, bin_m=20.0)
    index = RoadIndex([made if is_route else road(lats_deg, lons_deg)])
    assert best(index, 200.0, reach_m - 1.0, 90.0) is not None
    assert best(index, 200.0, reach_m + 1.0, 90.0) is None
    assert (best(index, 200.0, 0.0, 270.0) is None) == is_route


def test_a_road_that_runs_twice_through_a_place_goes_on_where_it_was() -> None:
    """Two turns of a coil, 6 m apart: the nearest would jump between them."""
    turn = np.linspace(0.0, 4.0 * np.pi, 400)
    radius_m = 150.0 + 6.0 * turn / (2.0 * np.pi)
    lats_deg, lons_deg = degrees(radius_m * np.sin(turn), radius_m * np.cos(turn))
    coil = road(lats_deg, lons_deg)
    matcher = Matcher(RoadIndex([coil]), CHANGE_COST)
    matcher.set_out(sight(0.0, 150.0, 90.0), Candidate(coil.road_id, 1, 0.0, 0.0, 90.0))
    far_m = []
    for i in range(0, 399, 4):
        step_m = 4.0 * float(np.hypot(np.diff(radius_m)[0], radius_m[i] * turn[1]))
        heading_deg = float(np.degrees(turn[i])) + 90.0
        # driven 3 m further out than the line: midway to the next turn
        out_m = radius_m[i] + 3.1
        east_m, north_m = out_m * float(np.sin(turn[i])), out_m * float(np.cos(turn[i]))
        seen = sight(east_m, north_m, heading_deg % 360.0, 0.1 * i)
        found = matcher.observe(seen, Moves.measured(step_m))
        assert found is not None
        expected_m = coil.line.length_m * (i / 399.0)
        far_m.append(abs(found.candidate.along_m - expected_m))
    assert max(far_m) < 60.0


def test_the_own_route_goes_before_a_nearer_road() -> None:
    roads = KnownRoads([RoadProfile(road(*straight()), {})])
    at_street = sight(200.0, 2.0, 90.0)
    assert {each.edge_id for each in roads.near(at_street)} != {"7"}
    roads.follow(Line(*straight(beside_m=20.0)), "7", loop=False, bin_m=20.0)
    assert {each.edge_id for each in roads.near(at_street)} == {"7"}
    assert "7" not in {each.edge_id for each in roads.near(sight(200.0, 24.0, 90.0))}


def test_a_road_goes_on_beside_another_that_is_nearer_for_a_while() -> None:
    """A street begins 20 m beside: who came along one is on it until the evidence has added up."""
    lats_deg, lons_deg = straight(2000.0, beside_m=20.0)
    own, beside = road(*straight(2000.0)), road(lats_deg[10:], lons_deg[10:])
    matcher = Matcher(RoadIndex([own, beside]), CHANGE_COST)
    ids = []
    for step in range(120):
        north_m = 0.0 if step < 20 else -17.0
        found = matcher.observe(sight(10.0 * step, north_m, 90.0, step), Moves.measured(10.0))
        assert found is not None
        ids.append(found.candidate.edge_id)
    changes_m = [10 * step for step in range(1, 120) if ids[step] != ids[step - 1]]
    assert ids[0] == own.road_id
    assert ids[-1] == beside.road_id
    assert len(changes_m) == 1
    assert 300 <= changes_m[0] <= 600


def test_a_loop_goes_on_over_its_seam_and_against_its_line() -> None:
    turn = np.linspace(0.0, 2.0 * np.pi, 100)
    ring = road(*degrees(150.0 * np.sin(turn), 150.0 * np.cos(turn)))
    index, length_m = RoadIndex([ring]), ring.line.length_m
    for direction, heading_deg in ((1, 90.0), (-1, 270.0)):
        side_m = 5.0 * direction
        before = best(index, -side_m, 150.0, heading_deg)
        after = best(index, side_m, 150.0, heading_deg)
        assert before is not None
        assert after is not None
        assert before.direction == after.direction == direction
        ends = index.near(sight(-side_m, 150.0, heading_deg))
        starts = index.near(sight(side_m, 150.0, heading_deg))
        ways_m = [index.advance_m(end, start, 10.0) for end in ends for start in starts]
        assert all(way_m == pytest.approx(10.0, abs=2.0) for way_m in ways_m)
        assert abs(before.along_m - after.along_m) > 0.5 * length_m
