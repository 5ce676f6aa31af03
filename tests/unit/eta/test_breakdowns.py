"""What is far beyond the usual is a breakdown, unless it happens to one vehicle after the other."""

from wayline_eta.breakdowns import Breakdowns


def test_five_times_as_long_as_usual_and_five_minutes_more_is_one() -> None:
    places = Breakdowns()
    assert places.is_one("leg", 700.0, 60.0)
    assert not places.is_one("leg", 340.0, 60.0), "five times, but no five minutes"
    assert not places.is_one("long leg", 1_500.0, 600.0), "five minutes, but a jam does that"


def test_what_befalls_three_vehicles_in_a_row_is_how_things_are() -> None:
    """A street that is dug up would else never be learned."""
    places = Breakdowns()
    said = [places.is_one("leg", 700.0, 60.0) for _ in range(4)]
    assert said == [True, True, False, False]


def test_others_that_come_through_end_the_row() -> None:
    places = Breakdowns()
    said = [places.is_one("leg", took_s, 60.0) for took_s in (700.0, 60.0, 700.0, 60.0, 700.0)]
    assert said == [True, False, True, False, True]


def test_each_place_has_a_row_of_its_own() -> None:
    places = Breakdowns()
    assert all(places.is_one(f"leg {at}", 700.0, 60.0) for at in range(5))
