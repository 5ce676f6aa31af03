"""The core: which roads it makes and knows again, when a run ends, what the horizon shows."""

import msgspec
import numpy as np
import pytest

from unit.slope_map.hilly_road import (
    LAT_DEG,
    LON_DEG,
    SECOND_NS,
    START_NS,
    bending_east,
    core,
    drive,
    ring,
    runs_of,
    true_alt_m,
    true_grade_pct,
)
from wayline.core import Sleep
from wayline.inputs import Flush, Tick
from wayline.line import Line
from wayline.messages import Horizon, Pose, Progress
from wayline.tuning import Tuning
from wayline_slope_map.core import SlopeMapCore
from wayline_slope_map.known_roads import KnownRoads
from wayline_slope_map.profile import RoadProfile
from wayline_slope_map.records import DrivenRun, FinishedRun, RoadLearned
from wayline_slope_map.sums import estimate, run_sums

DAY_NS = 86_400 * SECOND_NS
RING_M = 1200.0


def profile_of(run: FinishedRun) -> RoadProfile:
    bins = {
        at.bin_index: estimate(
            run_sums(at.grade_pct, at.grade_std_pct, at.alt_m, at.alt_std_m, run.end_ns)
        )
        for at in run.bins
        if at.sensor == "fused"
    }
    return RoadProfile(run.road, {run.direction: bins})


def horizons(core: SlopeMapCore, messages: list[msgspec.Struct]) -> list[Horizon]:
    outputs = [output for message in messages for output in core.handle(message, "test")]
    return [output for output in outputs if isinstance(output, Horizon)]


def indices(run: FinishedRun) -> set[int]:
    return {at.bin_index for at in run.bins if at.sensor == "fused"}


@pytest.fixture(scope="module")
def first_run() -> FinishedRun:
    (run,) = runs_of(core(), drive(seed=1, length_m=3000.0))
    return run


def test_a_first_drive_makes_one_road_with_a_bin_every_20_m(first_run: FinishedRun) -> None:
    assert first_run.road.road_id.startswith("road-")
    assert first_run.direction == 1
    assert indices(first_run) == set(range(first_run.road.bins))
    assert first_run.road.line.length_m == pytest.approx(3030.0, abs=40.0)
    assert {at.sensor for at in first_run.bins} == {"fused", "gps", "barometer"}


def test_a_second_drive_knows_the_road_again(first_run: FinishedRun) -> None:
    again = core(profiles=[profile_of(first_run)])
    (run,) = runs_of(again, drive(seed=2, length_m=3000.0, start_ns=START_NS + DAY_NS))
    assert run.road == first_run.road
    assert indices(run) == indices(first_run)


def test_the_way_back_is_the_same_road_with_its_grade_turned(first_run: FinishedRun) -> None:
    again = core(profiles=[profile_of(first_run)])
    back = drive(seed=3, length_m=3000.0, backwards=True, start_ns=START_NS + DAY_NS)
    (run,) = runs_of(again, back)
    assert (run.road, run.direction) == (first_run.road, -1)
    there = {at.bin_index: at.grade_pct for at in first_run.bins if at.sensor == "fused"}
    back_pct = {at.bin_index: at.grade_pct for at in run.bins if at.sensor == "fused"}
    both = sorted(there.keys() & back_pct.keys())
    assert len(both) > 140
    sums_pct = np.array([there[i] + back_pct[i] for i in both])
    assert np.std(sums_pct) < 0.4 * np.std([there[i] for i in both])


def test_in_reverse_a_vehicle_travels_the_road_the_other_way(first_run: FinishedRun) -> None:
    reversing = [
        msgspec.structs.replace(
            message, heading_deg=((message.heading_deg or 0.0) + 180.0) % 360.0, speed_mps=-5.0
        )
        if isinstance(message, Pose)
        else message
        for message in drive(seed=2, length_m=1000.0, start_ns=START_NS + DAY_NS)
    ]
    (run,) = runs_of(core(profiles=[profile_of(first_run)]), reversing)
    assert (run.road, run.direction) == (first_run.road, 1)


def test_a_road_that_goes_on_is_a_new_one_from_where_the_known_one_ends(
    first_run: FinishedRun,
) -> None:
    again = core(profiles=[profile_of(first_run)])
    known, new = runs_of(again, drive(seed=4, length_m=4000.0, start_ns=START_NS + DAY_NS))
    assert known.road == first_run.road
    assert new.road.line.length_m == pytest.approx(1000.0, abs=60.0)
    assert known.end_ns <= new.start_ns


def test_a_crossing_is_no_match(first_run: FinishedRun) -> None:
    across = drive(seed=5, length_m=1000.0, path=lambda d: (np.full_like(d, 1500.0), d - 500.0))
    (run,) = runs_of(core(profiles=[profile_of(first_run)]), across)
    assert run.road.road_id != first_run.road.road_id


def test_a_street_that_crosses_a_known_road_at_a_small_angle_is_not_cut(
    first_run: FinishedRun,
) -> None:
    """At 32 degrees, within 25 m of the road for 95 m."""
    road_m = bending_east(np.array([1650.0, 1651.0]))
    bearing_rad = np.arctan2(*np.diff(road_m)[:, 0]) - np.radians(32.0)
    slanted = drive(
        seed=5,
        length_m=1000.0,
        path=lambda d: (
            road_m[0][0] + (d - 500.0) * np.sin(bearing_rad),
            road_m[1][0] + (d - 500.0) * np.cos(bearing_rad),
        ),
    )
    (run,) = runs_of(core(profiles=[profile_of(first_run)]), slanted)
    assert run.road.line.length_m > 900.0


def test_three_laps_of_an_unknown_loop_are_three_runs_of_one_road() -> None:
    laps = drive(
        seed=6, length_m=3 * RING_M - 20.0, path=ring(RING_M), grade_of=lambda d: d % RING_M
    )
    runs = runs_of(core(), laps)
    assert len(runs) == 3
    assert len({run.road.road_id for run in runs}) == 1
    assert runs[0].road.loop
    assert all(runs[i].end_ns <= runs[i + 1].start_ns for i in range(2))
    assert all(len(indices(run)) >= RING_M / 20.0 - 3 for run in runs)


def test_each_lap_of_a_known_loop_ends_a_run_and_the_horizon_wraps() -> None:
    first = runs_of(
        core(), drive(seed=6, length_m=1.5 * RING_M, path=ring(RING_M), grade_of=lambda d: d)
    )[0]
    laps = drive(seed=7, length_m=2.5 * RING_M, path=ring(RING_M), start_ns=START_NS + DAY_NS)
    knowing = core(profiles=[profile_of(first)])
    runs, ahead = [], None
    for message in laps:
        for output in knowing.handle(message, "test"):
            if isinstance(output, DrivenRun):
                runs.append((output, message))
            elif isinstance(output, Horizon):
                ahead = output
    assert [isinstance(message, Flush) for _, message in runs] == [False, False, True]
    assert ahead is not None
    assert all(point.grade_pct is not None for point in ahead.points[1:])


def test_a_route_is_the_road_where_it_is_followed_in_its_direction() -> None:
    run = runs_of(core(), drive(seed=1, length_m=3000.0))[0]
    line = Line(*np.array(run.road.points).T)
    on_route = core(route=line)
    (followed,) = runs_of(on_route, drive(seed=8, length_m=3000.0))
    assert (followed.road.road_id, followed.direction) == ("7", 1)
    against = core(route=line)
    (other,) = runs_of(against, drive(seed=8, length_m=3000.0, backwards=True))
    assert other.road.road_id.startswith("road-")


def test_the_horizon_shows_earlier_runs_only(first_run: FinishedRun) -> None:
    unknown = horizons(core(), drive(seed=9, length_m=1000.0))
    assert {(len(at.points), at.road_id) for at in unknown} == {(0, None)}
    knowing = core(profiles=[profile_of(first_run)])
    seen = horizons(knowing, drive(seed=9, length_m=2000.0, start_ns=START_NS + DAY_NS))
    assert {point.runs for at in seen for point in at.points} <= {0, 1}
    assert {point.updated_ns for at in seen for point in at.points} == {first_run.end_ns, None}


def test_the_horizon_lies_ahead_of_the_vehicle(first_run: FinishedRun) -> None:
    knowing = core(profiles=[profile_of(first_run)])
    seen = horizons(knowing, drive(seed=9, length_m=2000.0, start_ns=START_NS + DAY_NS))
    at = next(at for at in seen if at.t_ns == START_NS + DAY_NS + 40 * SECOND_NS)
    assert at.road_id == first_run.road.road_id
    assert at.position_m == pytest.approx(600.0, abs=25.0)
    assert [point.distance_m for point in at.points] == [20.0 * i for i in range(101)]
    known = [point for point in at.points if point.grade_pct is not None and point.alt_m]
    truth_pct = true_grade_pct(600.0 + np.array([point.distance_m for point in known]))
    assert np.std(
        np.array([point.grade_pct for point in known], dtype=float) - truth_pct
    ) < 0.4 * np.std(truth_pct)
    truth_m = true_alt_m(600.0 + np.array([point.distance_m for point in known]))
    assert np.std(np.array([point.alt_m for point in known], dtype=float) - truth_m) < 2.0
    end = next(at for at in seen if at.t_ns == START_NS + DAY_NS + 130 * SECOND_NS)
    assert [point.grade_pct for point in end.points if point.distance_m > 1200.0] == [None] * 40


def test_the_position_moves_on_between_the_places(first_run: FinishedRun) -> None:
    knowing = core(profiles=[profile_of(first_run)])
    seen = horizons(knowing, drive(seed=9, length_m=1000.0, start_ns=START_NS + DAY_NS))
    steps_m = np.diff([at.position_m for at in seen if at.position_m is not None])
    assert len(steps_m) > 60
    assert np.all(np.abs(steps_m - 15.0) < 1.5)


def test_a_learned_road_is_on_the_horizon_from_then_on(first_run: FinishedRun) -> None:
    learning = core()
    learning.handle(RoadLearned(profile_of(first_run)), "slope-map")
    later = drive(seed=9, length_m=500.0, start_ns=START_NS + DAY_NS)
    assert horizons(learning, later)[-1].road_id == first_run.road.road_id


def test_without_a_fresh_pose_the_horizon_ends_with_an_empty_one(first_run: FinishedRun) -> None:
    knowing = core(profiles=[profile_of(first_run)])
    for message in drive(seed=9, length_m=500.0)[:-1]:
        knowing.handle(message, "test")
    late, asleep = knowing.handle(Tick(START_NS + 60 * SECOND_NS), "test")
    assert isinstance(late, Horizon)
    assert (late.road_id, late.points, asleep) == (None, (), Sleep())
    assert knowing.handle(Tick(START_NS + 61 * SECOND_NS), "test") == [Sleep()]


def test_a_pose_that_was_old_when_it_came_has_no_road_ahead(first_run: FinishedRun) -> None:
    knowing = core(profiles=[profile_of(first_run)])
    messages = drive(seed=9, length_m=500.0)
    last = max((each for each in messages if isinstance(each, Pose)), key=lambda pose: pose.t_ns)
    for message in messages[:-1]:
        knowing.handle(message, "test")
    tick_ns = -(-last.t_ns // SECOND_NS) * SECOND_NS
    (fresh,) = knowing.handle(Tick(tick_ns), "test")
    assert isinstance(fresh, Horizon)
    assert fresh.road_id is not None
    ended, _ = knowing.handle(Tick(tick_ns, age_ns=3600 * SECOND_NS), "test")
    assert isinstance(ended, Horizon)
    assert ended.road_id is None


@pytest.mark.parametrize("backwards", [False, True])
def test_a_horizon_tells_the_way_of_travel(first_run: FinishedRun, backwards: bool) -> None:
    knowing = core(profiles=[profile_of(first_run)])
    seen = horizons(knowing, drive(seed=9, length_m=2000.0, backwards=backwards))
    assert {at.direction for at in seen if at.road_id} == {-1 if backwards else 1}


def test_on_a_loop_a_vehicle_that_cannot_be_placed_is_carried_on_past_the_seam() -> None:
    first = runs_of(
        core(), drive(seed=6, length_m=1.5 * RING_M, path=ring(RING_M), grade_of=lambda d: d)
    )[0]
    knowing = core(profiles=[profile_of(first)])
    length_m = first.road.line.length_m
    lat_deg, lon_deg, heading_deg = first.road.line.point_at(length_m - 20.0)
    placed = Pose(
        t_ns=START_NS,
        mode="fused",
        lat_deg=lat_deg,
        lon_deg=lon_deg,
        heading_deg=heading_deg,
        speed_mps=10.0,
    )
    knowing.handle(placed, "fusion")
    unsure = msgspec.structs.replace(
        placed, t_ns=START_NS + SECOND_NS, distance_m=60.0, east_std_m=99.0
    )
    knowing.handle(unsure, "fusion")
    (ahead,) = knowing.handle(Tick(START_NS + SECOND_NS), "clock")
    assert isinstance(ahead, Horizon)
    assert ahead.position_m == pytest.approx(40.0, abs=1.0)


def test_a_silence_or_a_restart_of_fusion_ends_a_run() -> None:
    whole = drive(seed=10, length_m=2000.0)[:-1]
    end_ns = START_NS + 133 * SECOND_NS
    silent = [*whole, Pose(t_ns=end_ns + 90 * SECOND_NS, mode="lost", distance_m=2e3)]
    restarted = [*whole, Pose(t_ns=end_ns + SECOND_NS, mode="starting", distance_m=0.0)]
    going_on = [*whole, Pose(t_ns=end_ns + 9 * SECOND_NS, mode="lost", distance_m=2e3)]
    assert [len(runs_of(core(), part)) for part in (silent, restarted, going_on)] == [1, 1, 0]


def test_a_parked_vehicles_run_ends_once_though_poses_go_on() -> None:
    """Fusion gives poses for as long as it runs; a queue of two minutes is not parking."""
    whole = drive(seed=10, length_m=2000.0)[:-1]
    last = next(message for message in reversed(whole) if isinstance(message, Pose))
    standing = [
        msgspec.structs.replace(last, t_ns=last.t_ns + second * SECOND_NS)
        for second in range(1, 1000)
    ]
    assert len(runs_of(core(), [*whole, *standing[:120]])) == 0
    assert len(runs_of(core(), [*whole, *standing])) == 1


@pytest.mark.parametrize(("creep_mps", "runs"), [(0.07, 1), (0.15, 0)])
def test_a_standing_vehicles_distance_may_creep_by_30_m_while_it_parks(
    creep_mps: float, runs: int
) -> None:
    """In five minutes 21 m are noise; 45 m are a queue that moves."""
    whole = drive(seed=10, length_m=2000.0)[:-1]
    last = next(message for message in reversed(whole) if isinstance(message, Pose))
    creeping = [
        msgspec.structs.replace(
            last,
            t_ns=last.t_ns + second * SECOND_NS,
            distance_m=last.distance_m + second * creep_mps,
        )
        for second in range(1, 800)
    ]
    assert len(runs_of(core(), [*whole, *creeping])) == runs


@pytest.mark.parametrize(("unplaced_m", "is_ahead"), [(100.0, True), (200.0, False)])
def test_a_vehicle_that_cannot_be_placed_is_carried_on_for_150_m(
    first_run: FinishedRun, unplaced_m: float, is_ahead: bool
) -> None:
    """Farther on it may have left its road, and nothing is told of what lies ahead."""
    knowing = core(profiles=[profile_of(first_run)])
    messages = drive(seed=9, length_m=500.0)[:-1]
    for message in messages:
        knowing.handle(message, "test")
    last = next(message for message in reversed(messages) if isinstance(message, Pose))
    t_ns = (last.t_ns // SECOND_NS + 1) * SECOND_NS
    travelled_m = last.distance_m + unplaced_m
    unsure = msgspec.structs.replace(last, t_ns=t_ns, distance_m=travelled_m, east_std_m=99.0)
    knowing.handle(unsure, "fusion")
    (horizon,) = knowing.handle(Tick(t_ns), "clock")
    assert isinstance(horizon, Horizon)
    assert (horizon.road_id is not None) is is_ahead


def test_poses_without_a_place_and_input_without_poses_make_no_run() -> None:
    lost = [
        msgspec.structs.replace(message, mode="lost") if isinstance(message, Pose) else message
        for message in drive(seed=11, length_m=1000.0)
    ]
    assert runs_of(core(), lost) == []
    assert runs_of(core(), [Flush(START_NS), Flush(START_NS)]) == []


def test_a_pose_after_the_end_of_input_begins_a_new_run() -> None:
    twice = core()
    there = drive(seed=12, length_m=1000.0)
    on = [
        msgspec.structs.replace(message, distance_m=message.distance_m + 1000.0)
        if isinstance(message, Pose)
        else message
        for message in drive(seed=12, length_m=1000.0, start_ns=START_NS + 67 * SECOND_NS)
    ]
    assert len(runs_of(twice, there)) == 1
    assert len(runs_of(twice, on)) == 1


def test_what_one_vehicle_taught_lies_on_the_horizon_of_another(first_run: FinishedRun) -> None:
    roads = KnownRoads()
    teaching, other = (SlopeMapCore(roads, Tuning(), name) for name in ("car", "truck"))
    teaching.handle(RoadLearned(profile_of(first_run)), "slope-map")
    later = drive(seed=9, length_m=500.0, start_ns=START_NS + DAY_NS)
    assert horizons(other, later)[-1].road_id == first_run.road.road_id


@pytest.mark.parametrize(
    ("assigned", "followed", "is_on_route", "expected"),
    [
        pytest.param("8", None, True, "8", id="assigned"),
        pytest.param(None, "7", True, "7", id="seen to follow it"),
        pytest.param("8", "7", True, "8", id="assigned goes before seen"),
        pytest.param(None, "7", False, "road-", id="has left it"),
        pytest.param(None, None, True, "road-", id="nobody knows"),
    ],
)
def test_of_several_routes_a_road_is_the_one_that_its_vehicle_follows(
    assigned: str | None, followed: str | None, is_on_route: bool, expected: str
) -> None:
    (run,) = runs_of(core(), drive(seed=1, length_m=1_000.0))
    line, roads = Line(*np.array(run.road.points).T), KnownRoads()
    for route_id in ("7", "8"):
        roads.follow(line, route_id, loop=False, bin_m=20.0)
    follower = SlopeMapCore(roads, Tuning(), "bus", route_id=assigned)
    if followed is not None:
        follower.handle(progress_on(followed, on_route=is_on_route), "eta")
    (driven,) = runs_of(follower, drive(seed=2, length_m=1_000.0))
    assert driven.road.road_id.startswith(expected)


def progress_on(route_id: str, *, on_route: bool) -> Progress:
    return Progress(
        t_ns=START_NS,
        route_id=route_id,
        distance_m=0.0,
        lat_deg=LAT_DEG,
        lon_deg=LON_DEG,
        cross_track_m=0.0,
        distance_std_m=5.0,
        on_route=on_route,
        speed_mps=0.0,
    )
