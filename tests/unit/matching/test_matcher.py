"""The likeliest place on a network, by where the vehicle was seen and how far it came."""

import itertools

import numpy as np
import pytest

from unit.eta.route_drives import Metres
from unit.matching.streets import Streets, sight
from wayline.matching.emission import Emission, news, turn_deg
from wayline.matching.matcher import Matched, Matcher
from wayline.matching.network import Candidate, Sight
from wayline.matching.transition import JUMP_COST, Moves

FORK = Streets(
    {
        "trunk": [(0, 0), (500, 0)],
        "main": [(500, 0), (1500, 0)],
        "branch": [(500, 0), (1500, 60)],
    },
    joins={"trunk": ["main", "branch"]},
)
BESIDE = Streets({"south": [(0, 0), (2000, 0)], "north": [(0, 20), (2000, 20)]}, joins={})


def followed(matcher: Matcher, drive_m: list[Metres]) -> list[Matched | None]:
    """One sight a second; the vehicle's wheels know its way."""
    seen, before = [], drive_m[0]
    for second, at_m in enumerate(drive_m):
        travelled_m = float(np.hypot(at_m[0] - before[0], at_m[1] - before[1]))
        seen.append(matcher.observe(sight(second, at_m, 90.0), Moves.measured(travelled_m)))
        before = at_m
    return seen


def edges(seen: list[Matched | None]) -> list[str]:
    return [each.candidate.edge_id if each else "" for each in seen]


def test_a_vehicle_drives_over_a_fork_onto_the_street_that_it_takes() -> None:
    drive: list[Metres] = [(10.0 * s, max(10.0 * s - 500.0, 0.0) * 0.06) for s in range(140)]
    seen = edges(followed(Matcher(FORK), drive))
    assert seen[:50] == ["trunk"] * 50
    assert seen[-1] == "branch"


def test_errors_that_last_for_seconds_do_not_lift_it_onto_the_street_beside() -> None:
    drive: list[Metres] = [(10.0 * s, 16.0 if 30 <= s < 50 else 0.0) for s in range(100)]
    assert set(edges(followed(Matcher(BESIDE), drive))) == {"south"}


def test_a_wrong_first_guess_is_given_up_once_the_evidence_is_against_it() -> None:
    drive: list[Metres] = [(10.0 * s, 19.0 if s else 9.0) for s in range(200)]
    seen = edges(followed(Matcher(BESIDE), drive))
    assert (seen[0], seen[-1]) == ("south", "north")


def test_a_street_that_no_way_leads_to_costs_a_jump_and_is_reached_all_the_same() -> None:
    moved: list[Metres] = [(10.0 * s, 0.0 if s < 50 else 90.0) for s in range(80)]
    far = Streets({"south": [(0, 0), (2000, 0)], "north": [(0, 90), (2000, 90)]}, joins={})
    seen = followed(Matcher(far), moved)
    assert edges(seen)[49:] == ["south", *edges(seen)[50:]]
    last = seen[-1]
    assert last is not None
    assert last.candidate.edge_id == "north"
    assert last.total_m == pytest.approx(790.0, abs=1.0)


def test_where_no_street_is_near_nothing_is_told_and_the_next_sight_is_a_first_one() -> None:
    matcher = Matcher(BESIDE)
    seen = followed(matcher, [(0.0, 0.0), (10.0, 400.0), (1000.0, 19.0)])
    assert edges(seen) == ["south", "", "north"]


def test_a_vehicle_that_sets_out_begins_where_it_is_said_to() -> None:
    matcher = Matcher(BESIDE)
    matcher.set_out(sight(0, (0.0, 20.0)), Candidate("south", 1, 0.0, 20.0, 90.0))
    after = matcher.observe(sight(1, (8.0, 18.0)), Moves.measured(8.0))
    assert after is not None
    assert after.candidate.edge_id == "south"
    assert after.total_m == pytest.approx(8.0, abs=0.1)


@pytest.mark.parametrize("seed", range(20))
def test_it_finds_the_cheapest_of_all_ways(seed: int) -> None:
    """Each way through all candidates of seven sights, reckoned one by one."""
    random = np.random.default_rng(seed)
    sights = [
        sight(second, (480.0 + 12.0 * second, float(random.normal(0.0, 12.0))), 90.0)
        for second in range(7)
    ]
    travelled_m = [0.0, *random.normal(12.0, 3.0, 6).tolist()]
    matcher = Matcher(FORK)
    for each, moved_m in zip(sights, travelled_m, strict=True):
        found = matcher.observe(each, Moves.measured(moved_m))
    ways = itertools.product(*(FORK.near(each) for each in sights))
    cheapest = min(ways, key=lambda way: way_cost(way, sights, travelled_m))
    assert found is not None
    assert found.candidate == cheapest[-1]


def way_cost(way: tuple[Candidate, ...], sights: list[Sight], travelled_m: list[float]) -> float:
    cost, last = 0.0, None
    for number, (place, each) in enumerate(zip(way, sights, strict=True)):
        cost += Emission(last, each).cost(place)
        if number:
            advance_m = FORK.advance_m(way[number - 1], place, travelled_m[number])
            cost += Moves.measured(travelled_m[number]).cost(advance_m)
        last = each
    return cost


def test_a_way_costs_what_it_differs_from_the_wheels_and_never_more_than_a_jump() -> None:
    moves = Moves.measured(100.0)
    costs = [moves.cost(advance_m) for advance_m in (100.0, 110.0, 160.0, 5000.0)]
    assert costs[0] == 0.0
    assert costs == sorted(costs)
    assert costs[-1] < JUMP_COST == moves.cost(None)


def test_where_nobody_saw_the_way_all_between_the_straight_one_and_the_expected_is_likely() -> None:
    moves = Moves.between(200.0, 300.0)
    assert moves.cost(300.0) == 0.0
    assert 0.0 < moves.cost(240.0) < 0.2
    assert moves.cost(150.0) > moves.cost(200.0)
    assert moves.cost(450.0) > 1.0


def test_the_course_of_a_vehicle_that_stands_is_no_news_and_an_unsure_one_tells_nothing() -> None:
    place = Candidate("e", 1, 0.0, 0.0, 90.0)
    moving, standing = sight(1, (0.0, 0.0), 180.0), sight(1, (0.0, 0.0), 180.0, stands=True)
    before = sight(0, (0.0, 0.0), 90.0)
    assert Emission(before, moving).cost(place) > 0.0
    assert Emission(before, standing).cost(place) == 0.0
    assert Emission(None, standing).cost(place) > 0.0
    assert turn_deg(moving, place) == 90.0
    assert turn_deg(moving._replace(course_std_deg=60.0), place) == 0.0


def test_sights_in_quick_succession_are_a_share_of_news_unless_one_is_much_surer() -> None:
    unsure, sure = sight(0, (0.0, 0.0))._replace(std_m=40.0), sight(0.1, (0.0, 0.0))
    assert news(None, sure) == 1.0
    assert news(sure, sight(1.1, (0.0, 0.0))) == pytest.approx(0.1)
    assert news(unsure, sure) > 0.9
    assert news(sure, sight(60, (0.0, 0.0))) == 1.0
