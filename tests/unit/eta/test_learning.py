"""What vehicles teach: legs, dwells, traffic now, and how wide ranges must be."""

import math
from collections.abc import Sequence
from pathlib import Path
from zoneinfo import ZoneInfo

import msgspec
import numpy as np
import pytest

from unit.eta.route_drives import SECOND_NS, SQUARE, START_NS, Metres, poses, route_of
from wayline.database import open_database
from wayline.messages import Arrivals, StopEvent, StopEventKind
from wayline.node import Node
from wayline.tuning import Tuning
from wayline_eta.congestion import CONGESTION_STD, Congestion
from wayline_eta.core import eta_node
from wayline_eta.experience import Experience
from wayline_eta.forecasts import Forecast, Forecasts
from wayline_eta.leg_times import LegTimes
from wayline_eta.legs import Legs
from wayline_eta.lessons import Lessons, lessons_by
from wayline_eta.ranges import Ranges
from wayline_eta.records import Came, Learned, Taken
from wayline_eta.store import EtaStore, EtaTables

LINE: list[Metres] = [(0, 0), (3000, 0)]
ROUTE = route_of(LINE, stops_m=[0.0, 1000.0, 2000.0])
LOOP = route_of(SQUARE, stops_m=[0.0, 1000.0])
UTC = ZoneInfo("UTC")
HOUR_NS = 3_600 * SECOND_NS
DAY_NS = 24 * HOUR_NS


def event(seconds: float, stop: int, kind: StopEventKind, lap: int = 0) -> StopEvent:
    return StopEvent(
        t_ns=START_NS + round(seconds * SECOND_NS),
        route_id="r",
        stop_id=f"s{stop}",
        stop_sequence=stop + 1,
        kind=kind,
        distance_m=0.0,
        lap=lap,
    )


def taken(events: Sequence[StopEvent], legs: Legs) -> list[tuple[str | None, float, float]]:
    times = LegTimes(legs, [1, 2, 3][: len(legs.keys)])
    found = [times.observe(each) for each in events]
    return [
        (one.leg and one.leg.key, round(one.travel_s), round(one.dwell_s)) for one in found if one
    ]


def test_legs_take_from_the_departure_at_one_stop_to_the_arrival_at_the_next() -> None:
    events = [
        event(0, 0, "arrived"),
        event(20, 0, "departed"),
        event(150, 1, "passed"),
        event(300, 2, "arrived"),
        event(330, 2, "departed"),
    ]
    assert taken(events, Legs(ROUTE, "r")) == [
        (None, 0, 20),
        ("r|s0>s1", 130, 0),
        ("r|s1>s2", 150, 30),
    ]


def test_a_stop_left_out_ends_what_can_be_said_of_the_legs_around_it() -> None:
    events = [event(0, 0, "passed"), event(90, 1, "skipped"), event(300, 2, "passed")]
    assert taken(events, Legs(ROUTE, "r")) == [(None, 0, 0), (None, 0, 0)]


def test_on_a_loop_the_last_leg_ends_in_the_next_lap() -> None:
    legs = Legs(LOOP, "r")
    events = [event(0, 1, "passed"), event(100, 0, "passed", lap=1)]
    assert taken(events, legs)[1] == ("r|s1>s0", 100, 0)
    assert legs.to(0) is not None
    assert sum(leg.planned_s for leg in legs.legs) == pytest.approx(LOOP.duration_s)


def drove(leg: str, planned_s: float, travel_s: float, t_ns: int, dwell_s: float = 20.0) -> Taken:
    return Taken(t_ns, leg, "r", planned_s, travel_s, "r|s1", dwell_s)


def experienced(runs: Sequence[Taken], *, is_now: bool = False) -> Experience:
    experience = Experience(UTC, is_timetable=False)
    for each in runs:
        experience.learn(each, is_now=is_now)
    return experience


LEG = Legs(ROUTE, "r").legs[0]


def test_a_plan_stands_until_somebody_has_driven_it() -> None:
    expected = experienced([]).travel(LEG, "r", START_NS)
    assert expected.seconds == pytest.approx(LEG.planned_s)
    assert 0.1 < expected.variance_s2**0.5 / LEG.planned_s < 0.4


def test_a_few_runs_replace_the_plan_and_make_surer() -> None:
    runs = [drove(LEG.key, 100.0, 240.0, START_NS + run * HOUR_NS) for run in range(8)]
    before, after = experienced([]), experienced(runs)
    ratio = after.travel(LEG, "r", START_NS).seconds / LEG.planned_s
    assert ratio == pytest.approx(2.4, rel=0.05)
    share = [each.travel(LEG, "r", START_NS) for each in (before, after)]
    stds = [each.variance_s2**0.5 / each.seconds for each in share]
    assert stds[1] < 0.7 * stds[0]


def test_other_legs_say_how_wrong_the_plan_is_on_earlier_runs_only() -> None:
    other = Legs(ROUTE, "r").legs[1]
    runs = [drove(LEG.key, 100.0, 200.0, START_NS + run) for run in range(10)]
    now_s = experienced(runs, is_now=True).travel(other, "r", START_NS + 60 * SECOND_NS).seconds
    assert now_s == pytest.approx(other.planned_s)
    later_s = experienced(runs).travel(other, "r", START_NS + DAY_NS).seconds
    assert later_s == pytest.approx(1.65 * other.planned_s, rel=0.05)
    elsewhere_s = experienced(runs).travel(other, "another", START_NS + DAY_NS).seconds
    assert elsewhere_s == pytest.approx(other.planned_s)


def test_a_plan_that_nobody_has_driven_may_be_wrong_as_a_whole_and_legs_show_how_much() -> None:
    """Of now: what is told does not go by them; of earlier runs it does."""
    right = [drove(LEG.key, 100.0, 100.0, START_NS + run) for run in range(10)]
    wrong = [drove(LEG.key, 100.0, 150.0, START_NS + run) for run in range(10)]

    def plan_std(taken: list[Taken], t_ns: int = START_NS) -> float:
        return experienced(taken).plan_std("r", t_ns)

    assert plan_std([]) == pytest.approx(0.3)
    assert plan_std(right) == pytest.approx(0.3 * (2.0 / 12.0) ** 0.5)
    assert plan_std(wrong) == pytest.approx(np.hypot(plan_std(right), np.log(1.5) * 10.0 / 12.0))
    assert plan_std(wrong, START_NS + DAY_NS) < 0.15


def test_the_rush_hour_is_another_time_than_the_evening() -> None:
    runs = []
    for day in range(10):
        noon_ns = START_NS + 7 * day * DAY_NS
        runs += [
            drove(LEG.key, 100.0, 200.0, noon_ns),
            drove(LEG.key, 100.0, 100.0, noon_ns + 6 * HOUR_NS),
        ]
    experience = experienced(runs)
    rush_s = experience.travel(LEG, "r", START_NS).seconds
    evening_s = experience.travel(LEG, "r", START_NS + 6 * HOUR_NS).seconds
    assert rush_s > 1.3 * evening_s


def test_a_breakdown_teaches_nothing() -> None:
    runs = [drove(LEG.key, 100.0, 100.0, START_NS + run) for run in range(5)]
    broken = drove(LEG.key, 100.0, 3_000.0, START_NS + 9, dwell_s=5_000.0)
    usual, after = experienced(runs), experienced([*runs, broken])
    assert after.travel(LEG, "r", START_NS) == usual.travel(LEG, "r", START_NS)
    assert after.dwell("r|s1", "r", 0.0) == usual.dwell("r|s1", "r", 0.0)


def test_a_jam_is_expected_by_who_follows_and_forgotten_within_the_hour() -> None:
    usual = [drove(LEG.key, 100.0, 100.0, START_NS - run * DAY_NS) for run in range(20, 0, -1)]
    jam = drove(LEG.key, 100.0, 180.0, START_NS)
    now, later = experienced(usual), experienced(usual)
    now.learn(jam)
    later.learn(jam, is_now=False)
    soon_s, unaware_s = (each.travel(LEG, "r", START_NS).seconds for each in (now, later))
    assert soon_s > 1.05 * unaware_s
    hours = START_NS + 2 * HOUR_NS
    assert now.travel(LEG, "r", hours).seconds == pytest.approx(
        later.travel(LEG, "r", hours).seconds, rel=0.01
    )


def test_congestion_fades_and_is_blended_with_what_was_measured_as_a_kalman_filter_does() -> None:
    """By hand: half an hour keeps exp(-1.5) of it, and variances weigh what is and what was."""
    before = Congestion(START_NS, 0.2, 0.004)
    kept = math.exp(-1_800.0 / 1_200.0)
    faded = before.at(START_NS + 1_800 * SECOND_NS)
    variance = kept**2 * 0.004 + (1.0 - kept**2) * CONGESTION_STD**2
    assert faded[1:] == pytest.approx((0.2 * kept, variance))
    after = faded.measured(0.5, 0.02)
    gain = variance / (variance + 0.02)
    assert after.mean == pytest.approx(0.2 * kept + gain * (0.5 - 0.2 * kept))
    assert after.variance == pytest.approx((1.0 - gain) * variance)


def test_dwells_are_learned_beside_the_plan() -> None:
    runs = [drove(LEG.key, 100.0, 100.0, START_NS + run, dwell_s=40.0) for run in range(20)]
    assert experienced(runs).dwell("r|s1", "r", 10.0).seconds == pytest.approx(40.0, abs=0.5)
    assert experienced([]).dwell("r|s1", "r", 10.0).seconds == 10.0


def test_a_stop_hardly_known_is_expected_as_the_others_of_its_plan() -> None:
    runs = [drove(LEG.key, 100.0, 100.0, START_NS + run, dwell_s=40.0) for run in range(20)]
    once = msgspec.structs.replace(runs[0], stop="r|s2")
    never_s, once_s = (
        experienced([*runs, *more]).dwell("r|s2", "r", 0.0).seconds for more in ([], [once])
    )
    assert never_s == 0.0, "a plan without dwells has them in its running times"
    assert once_s == pytest.approx(38.6, abs=0.7)


def test_how_late_vehicles_leave_is_learned_apart_from_how_long_they_board() -> None:
    """A first stop that they leave half a minute late however early they came."""
    waits = [drove(LEG.key, 100.0, 100.0, START_NS + run, dwell_s=30.0) for run in range(20)]
    waits = [msgspec.structs.replace(each, stop="r|s1|waits") for each in waits]
    experience = experienced(waits)
    assert experience.late("r|s1|waits").seconds == pytest.approx(28.0, abs=0.5)
    assert experience.dwell("r|s1", "r", 10.0).seconds == 10.0


def test_ranges_grow_where_arrivals_came_outside_and_shrink_where_they_did_not() -> None:
    rng = np.random.default_rng(1)
    narrow, wide = Ranges(), Ranges()
    for off in rng.normal(0.0, 2.0 / 1.2816, 2_000):
        narrow.learn(0, float(off))
        wide.learn(0, float(off) / 4.0)
    assert narrow.scales()[0].early == pytest.approx(2.0, rel=0.15)
    assert narrow.scales()[0].late == pytest.approx(2.0, rel=0.15)
    assert wide.scales()[0].late == pytest.approx(0.5, rel=0.2)
    assert narrow.scales()[4].late == 1.0, "of twenty minutes ahead nothing is known"


def test_a_forecast_a_minute_is_compared_with_what_came() -> None:
    forecasts = Forecasts()
    for second in range(0, 130, 10):
        made_ns = START_NS + second * SECOND_NS
        forecast = Forecast(made_ns, START_NS + 200 * SECOND_NS, 10 * SECOND_NS, 20 * SECOND_NS)
        if forecasts.is_due(made_ns):
            forecasts.make(1, forecast)
    came = list(forecasts.arrive(1, START_NS + 240 * SECOND_NS))
    assert [(each.off, each.span) for each in came] == [(2.0, 1), (2.0, 0)], "one a span"
    assert list(forecasts.arrive(1, START_NS + 250 * SECOND_NS)) == []


def laps(node: Node, begins_s: float) -> list[Arrivals]:
    """Two laps of the loop at half of the planned speed."""
    told = []
    for pose, _ in poses(SQUARE, [5.0] * 805, laps=True):
        later = msgspec.structs.replace(pose, t_ns=pose.t_ns + round(begins_s * SECOND_NS))
        told += [message for message in node.take(later, "fusion") if isinstance(message, Arrivals)]
    return told


def error_s(told: Sequence[Arrivals], after_s: float) -> float:
    """Of the arrival at the far stop as it was told after so long; it comes at 200 s."""
    first = told[0].t_ns
    arrivals = next(each for each in told if each.t_ns >= first + after_s * SECOND_NS)
    stop = next(each for each in arrivals.stops if each.stop_id == "s1")
    return (stop.arrival_ns - first) * 1e-9 - 200.0


def test_what_was_learned_is_kept_and_used_by_the_next_process(tmp_path: Path) -> None:
    url = f"sqlite:///{tmp_path / 'eta.db'}"
    errors = []
    for day in range(3):
        tables = EtaTables(open_database(url, "wayline_eta"))
        lessons = lessons_by(())
        for kept in tables.look():
            lessons.remember(kept)
        node = eta_node([LOOP], Tuning(), lessons, EtaStore(tables, "bus-7"))
        errors.append(abs(error_s(laps(node, day * 86_400.0), 10.0)))
    assert errors[0] > 70.0, "by the plan"
    assert errors[2] < 0.3 * errors[0]


def test_the_same_drive_twice_teaches_once_and_old_rows_go(tmp_path: Path) -> None:
    tables = EtaTables(open_database(f"sqlite:///{tmp_path / 'eta.db'}", "wayline_eta"))
    old = Learned(taken=drove(LEG.key, 100.0, 120.0, START_NS - 100 * DAY_NS))
    came = Came(START_NS - 60, "r|s1", "r", 1, 0.5)
    new = Learned(taken=drove(LEG.key, 100.0, 130.0, START_NS), came=(came,))
    for record in (old, new, new):
        tables.save("bus-7", record)
    *known, told = tables.look()
    assert told == came
    assert len(known) == 6, "of the dwell and the leg, each alone and among others"
    assert tables.look() == (), "told once"


def test_lessons_are_shared_by_the_vehicles_of_a_process() -> None:
    lessons: Lessons = lessons_by(())
    laps(eta_node([LOOP], Tuning(), lessons), 0.0)
    told = laps(eta_node([LOOP], Tuning(), lessons), 900.0)
    assert abs(error_s(told, 10.0)) < 30.0, "95 s by the plan"
    assert {stop.confidence for stop in told[-1].stops} == {"learned"}
