"""Runs that are kept later: their road is known before."""

from collections.abc import Sequence

import msgspec
import pytest

from unit.slope_map.hilly_road import core, drive, driven_of
from unit.slope_map.test_store import ROAD
from wayline.core import Record
from wayline.errors import InputError
from wayline_slope_map.known_roads import KnownRoads
from wayline_slope_map.profile import RoadProfile
from wayline_slope_map.records import DrivenRun, RoadLearned
from wayline_slope_map.roads import Road
from wayline_slope_map.teaching import Teaching


class Waiting:
    """A store whose database is away."""

    def __init__(self) -> None:
        self.records: list[Record] = []

    def save(self, record: Record) -> Sequence[msgspec.Struct]:
        self.records.append(record)
        return ()


@pytest.fixture(scope="module")
def driven() -> DrivenRun:
    (run,) = driven_of(core(), drive(seed=1, length_m=1_500.0))
    return run


def test_a_new_road_is_known_before_its_run_is_kept(driven: DrivenRun) -> None:
    store, roads = Waiting(), KnownRoads()
    (answer,) = Teaching(store, roads).save(driven)
    assert answer == RoadLearned(RoadProfile(driven.stretches[0].road, {}))
    assert store.records == [driven]


def test_a_known_road_keeps_its_slopes_until_the_run_is_kept(driven: DrivenRun) -> None:
    roads = KnownRoads([RoadProfile(driven.stretches[0].road, {})])
    assert list(Teaching(Waiting(), roads).save(driven)) == []


def test_a_route_that_was_followed_before_the_database_came_must_be_the_one_it_knows() -> None:
    roads = KnownRoads()
    roads.follow(ROAD.line, ROAD.road_id, loop=False, bin_m=20.0)
    roads.learn(RoadProfile(ROAD, {}))
    moved = tuple((lat_deg + 0.01, lon_deg) for lat_deg, lon_deg in ROAD.points)
    other = Road(ROAD.road_id, 20.0, loop=False, is_route=True, points=moved)
    with pytest.raises(InputError, match="is not the one whose slope was learned"):
        roads.learn(RoadProfile(other, {}))
