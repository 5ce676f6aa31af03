"""Roads: their lines, their names, and which one a place lies on."""

import numpy as np
import pytest

from wayline.errors import InputError
from wayline.geo import metres_per_degree
from wayline.line import Floats, Line
from wayline_slope_map.matching import Match, RoadIndex, chosen
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
    lat_deg, lon_deg = degrees(np.array(east_m), np.array(north_m))
    return chosen(index.near(float(lat_deg), float(lon_deg), heading_deg), None, 0.0)


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
    index = RoadIndex([coil])
    last: Match | None = Match(coil.road_id, 1, 0.0, 0.0)
    far_m = []
    for i in range(0, 399, 4):
        step_m = 4.0 * float(np.hypot(np.diff(radius_m)[0], radius_m[i] * turn[1]))
        heading_deg = float(np.degrees(turn[i])) + 90.0
        # driven 3 m further out than the line: midway to the next turn
        out = degrees(
            np.array((radius_m[i] + 3.1) * np.sin(turn[i])),
            np.array((radius_m[i] + 3.1) * np.cos(turn[i])),
        )
        near = index.near(float(out[0]), float(out[1]), heading_deg % 360.0)
        last = chosen(near, last, step_m)
        assert last is not None
        expected_m = coil.line.length_m * (i / 399.0)
        far_m.append(abs(last.along_m - expected_m))
    assert max(far_m) < 60.0


def test_the_own_route_goes_before_a_nearer_road() -> None:
    route = Match("7", 1, 100.0, 20.0)
    street = Match("road-1", 1, 50.0, 2.0)
    assert chosen([street, route], street, 10.0, "7") == route
    assert chosen([street, route], None, 10.0, None) == street
    assert chosen([], street, 10.0, "7") is None


@pytest.mark.parametrize(("apart_m", "goes_on"), [(25.0, True), (45.0, False)])
def test_a_road_goes_on_where_the_distance_puts_it_within_30_m(
    apart_m: float, goes_on: bool
) -> None:
    """After 10 m there are 2 m more; farther off, the nearer road is the one."""
    last = Match("road-1", 1, 100.0, 5.0)
    same, other = Match("road-1", 1, 110.0 + apart_m, 20.0), Match("road-2", 1, 50.0, 1.0)
    assert chosen([same, other], last, 10.0) == (same if goes_on else other)
