"""A road that was driven both ways, and a book that holds it."""

import pytest

from unit.slope_map.asking import NOW_NS, profile_of
from unit.slope_map.hilly_road import (
    SECOND_NS,
    START_NS,
    core,
    drive,
    runs_of,
)
from wayline_slope_map.book import SlopeBook
from wayline_slope_map.profile import RoadProfile


@pytest.fixture(scope="module")
def profile() -> RoadProfile:
    """A road of 3 km, driven once each way; one of its bins is not known forward."""
    (there,) = runs_of(core(), drive(seed=1, length_m=3000.0))
    knowing = core(profiles=[profile_of(there)])
    later_ns = START_NS + 3600 * SECOND_NS
    back_drive = drive(seed=2, length_m=3000.0, backwards=True, start_ns=later_ns)
    (back,) = runs_of(knowing, back_drive)
    both = profile_of(there, back)
    forward = {index: known for index, known in both.bins[1].items() if index != 40}
    return RoadProfile(both.road, {1: forward, -1: both.bins[-1]})


@pytest.fixture
def book(profile: RoadProfile) -> SlopeBook:
    return SlopeBook([profile], lambda: NOW_NS)
