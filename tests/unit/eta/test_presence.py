"""On and off the route, with hysteresis."""

import pytest

from wayline.tuning import Tuning
from wayline_eta.place_tracker import Place
from wayline_eta.presence import Presence


def place(offset_m: float, *, std_m: float = 3.0, turn_deg: float = 0.0) -> Place:
    return Place(500.0, offset_m, 3.0, std_m, turn_deg)


def after(*places: Place, speed_mps: float = 10.0) -> bool:
    presence = Presence(Tuning())
    for one in places:
        presence.observe(one, speed_mps)
    return presence.on_route


NEAR, BETWEEN, FAR = place(5.0), place(-50.0), place(-80.0)


@pytest.mark.parametrize(
    ("places", "on_route"),
    [
        ([NEAR], False),
        ([NEAR, NEAR], True),
        ([NEAR, NEAR, FAR], True),
        ([NEAR, NEAR, FAR, FAR], False),
        ([NEAR, NEAR, FAR, NEAR, FAR], True),
        ([NEAR, NEAR, BETWEEN, BETWEEN, BETWEEN], True),
        ([NEAR, NEAR, FAR, FAR, BETWEEN, BETWEEN], False),
        ([NEAR, NEAR, FAR, FAR, NEAR], False),
        ([NEAR, NEAR, FAR, FAR, NEAR, NEAR], True),
    ],
)
def test_two_matches_in_a_row_change_it(places: list[Place], on_route: bool) -> None:
    assert after(*places) is on_route


def test_an_uncertain_position_neither_ends_nor_begins_it() -> None:
    doubtful_far, doubtful_near = place(150.0, std_m=50.0), place(5.0, std_m=50.0)
    assert after(NEAR, NEAR, doubtful_far, doubtful_far)
    assert not after(doubtful_near, doubtful_near)


def test_the_wrong_way_counts_only_while_moving() -> None:
    back = place(5.0, turn_deg=175.0)
    assert not after(NEAR, NEAR, back, back)
    assert after(NEAR, NEAR, back, back, speed_mps=1.0)


def test_crossing_the_route_does_not_begin_it() -> None:
    crossing = place(5.0, turn_deg=88.0)
    assert not after(crossing, crossing, crossing)
    assert after(NEAR, NEAR, crossing, crossing)


def test_a_vehicle_that_stands_may_point_anywhere() -> None:
    """At a terminus it has come by one street and leaves by another."""
    aside = place(5.0, turn_deg=90.0)
    assert after(aside, aside, speed_mps=0.0)
    assert not after(aside, aside, speed_mps=1.0)
