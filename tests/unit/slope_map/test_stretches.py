"""A run cut into stretches of roads."""

import numpy as np
import pytest

from wayline.geo import metres_per_degree
from wayline_slope_map.matching import Match
from wayline_slope_map.roads import made_road
from wayline_slope_map.stretches import cut
from wayline_slope_map.track import Place

LAT_DEG, LON_DEG = 56.0, 10.0
NORTH_M, EAST_M = metres_per_degree(LAT_DEG)
STEP_M = 10.0
SECOND_NS = 1_000_000_000


@pytest.mark.parametrize(("jump_m", "stretches"), [(35.0, 1), (70.0, 2)])
def test_a_stretch_ends_where_road_and_travel_disagree_by_more_than_50_m(
    jump_m: float, stretches: int
) -> None:
    """A receiver's step is no reason, a part of the road left out is one."""
    east_m = np.arange(0.0, 1000.0, STEP_M)
    road, _ = made_road(np.full(len(east_m), LAT_DEG), LON_DEG + east_m / EAST_M, bin_m=20.0)
    places = []
    for step in range(60):
        travelled_m = step * STEP_M
        along_m = travelled_m + (jump_m if step >= 30 else 0.0)
        match = Match(road.road_id, 1, along_m, 0.0)
        lon_deg = LON_DEG + along_m / EAST_M
        places.append(Place(step * SECOND_NS, travelled_m, LAT_DEG, lon_deg, 90.0, match))
    assert len(cut(places, {road.road_id: road}, 20.0)) == stretches
