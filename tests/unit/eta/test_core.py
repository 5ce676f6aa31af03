"""The core on drives of known motion: progress against the truth, arrivals when they can be."""

import itertools

import numpy as np
import pytest

from unit.eta.route_drives import (
    SECOND_NS,
    SPUR,
    SQUARE,
    START_NS,
    TOWN,
    Metres,
    Told,
    follow,
    poses,
    route_of,
)
from wayline.core import Sleep
from wayline.inputs import Tick
from wayline.messages import Arrivals, GpsFix, Message, Pose, Progress
from wayline.route import Route
from wayline.tuning import Tuning
from wayline_eta.core import EtaCore, eta_node, make_eta_core

TUNING = Tuning()


def total_m(route: Route, told: Told) -> float:
    return told.progress.lap * route.length_m + told.progress.distance_m


def errors_m(route: Route, told: list[Told]) -> list[float]:
    return [abs(total_m(route, one) - one.true_m) for one in told]


def stop_ids(told: Told) -> list[str]:
    return [stop.stop_id for stop in told.arrivals.stops]


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_two_laps_of_a_loop_are_counted(seed: int) -> None:
    """With 4 m of wandering noise the place stays within 20 m, also in the corners."""
    route = route_of(SQUARE)
    drive = poses(SQUARE, [10.0] * 401, noise_m=4.0, seed=seed, laps=True)
    told = follow(EtaCore([route], TUNING), drive)
    assert len(told) >= 395
    assert max(errors_m(route, told)) < 20.0
    assert np.mean(errors_m(route, told)) < 5.0
    assert [lap for lap, _ in itertools.groupby(one.progress.lap for one in told)] == [0, 1, 2]
    assert all(one.progress.on_route for one in told)


@pytest.mark.parametrize("headed", [True, False])
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_a_street_driven_out_and_back_is_told_apart_by_motion(seed: int, headed: bool) -> None:
    """The spur's two directions lie on the same ground; no jump between them, either way."""
    route = route_of(SPUR)
    drive = poses(SPUR, [10.0] * 281, noise_m=4.0, seed=seed, headed=headed)
    told = follow(EtaCore([route], TUNING), drive)
    assert max(errors_m(route, told)) < 25.0
    distances_m = [one.progress.distance_m for one in told]
    assert all(after >= before - 1.0 for before, after in itertools.pairwise(distances_m))


def test_standing_at_the_start_is_not_a_lap_nor_an_arrival() -> None:
    route = route_of(SQUARE, stops_m=[0.0, 700.0])
    speeds = [0.0] * 120 + [10.0] * 60
    told = follow(EtaCore([route], TUNING), poses(SQUARE, speeds, noise_m=3.0, seed=5))
    standing = [one for one in told if one.progress.t_ns < START_NS + 115 * SECOND_NS]
    assert {one.progress.lap for one in told} == {0}
    assert max(one.progress.distance_m for one in standing) < 15.0
    assert all(stop_ids(one) == ["s1", "s0"] for one in standing[5:])
    assert told[-1].progress.distance_m == pytest.approx(590.0, abs=15.0)


def test_noise_at_standstill_does_not_take_progress_back() -> None:
    line: list[Metres] = [(0, 0), (2000, 0)]
    speeds = [10.0] * 50 + [0.0] * 200 + [10.0] * 50
    told = follow(EtaCore([route_of(line)], TUNING), poses(line, speeds, noise_m=5.0))
    distances_m = [one.progress.distance_m for one in told if one.true_m >= 450.0]
    steps_m = np.diff(distances_m)
    assert np.median(steps_m[:200]) == 0.0
    # extrapolation to a tick is nil here, so any step back is the place's own
    assert steps_m.min() >= 0.0


DETOUR: list[Metres] = [(0, 0), (600, 0), (600, 300), (1400, 300), (1400, 0), (2500, 0)]


def test_nothing_is_predicted_during_a_detour_and_again_soon_after_it() -> None:
    straight: list[Metres] = [(0, 0), (2500, 0)]
    route = route_of(straight, stops_m=[1000.0, 2000.0])
    drive = poses(DETOUR, [10.0] * 300, noise_m=3.0)
    told = follow(EtaCore([route], TUNING), drive)
    on_route = {one.true_m: one.progress.on_route for one in told}
    assert all(on for true_m, on in on_route.items() if true_m <= 650.0)
    assert not any(on for true_m, on in on_route.items() if 720.0 <= true_m <= 1920.0)
    assert all(on for true_m, on in on_route.items() if true_m >= 2040.0)
    assert all(bool(one.arrivals.stops) <= one.progress.on_route for one in told)
    back = next(one for one in told if one.true_m >= 2040.0)
    assert stop_ids(back) == ["s1"]
    assert back.progress.distance_m == pytest.approx(1440.0, abs=15.0)


def test_driving_the_route_backwards_is_not_following_it() -> None:
    line: list[Metres] = [(0, 0), (2000, 0)]
    route = route_of(line, stops_m=[500.0])
    backwards = poses(line[::-1], [10.0] * 150, noise_m=3.0)
    assert follow(EtaCore([route], TUNING), backwards) == []


def test_turning_round_on_the_route_leaves_it() -> None:
    line: list[Metres] = [(0, 0), (2000, 0)]
    route = route_of(line, stops_m=[1800.0])
    told = follow(EtaCore([route], TUNING), poses([(0, 0), (1000, 0), (0, 0)], [10.0] * 150))
    assert told[95].progress.on_route
    assert not any(one.progress.on_route for one in told if one.true_m > 1020.0)


def test_an_open_route_ends_at_its_end() -> None:
    line: list[Metres] = [(0, 0), (1000, 0)]
    route = route_of(line, stops_m=[0.0, 500.0, 1000.0])
    told = follow(EtaCore([route], TUNING), poses(line, [10.0] * 100 + [0.0] * 20, noise_m=2.0))
    assert told[-1].progress.distance_m == pytest.approx(1000.0, abs=6.0)
    assert told[-1].progress.lap == 0
    assert stop_ids(told[30]) == ["s1", "s2"]
    assert stop_ids(told[70]) == ["s2"]
    assert stop_ids(told[-1]) == []


def test_a_second_trip_on_an_open_route_has_all_its_stops_again() -> None:
    line: list[Metres] = [(0, 0), (1000, 0)]
    route = route_of(line, stops_m=[500.0, 1000.0])
    core = EtaCore([route], TUNING)
    first = follow(core, poses(line, [10.0] * 101))
    again = poses(line, [10.0] * 60, travelled_m=9000.0, start_ns=START_NS + 900 * SECOND_NS)
    second = follow(core, again)
    assert stop_ids(first[-1]) == []
    assert stop_ids(second[20]) == ["s0", "s1"]
    assert second[20].progress.distance_m == pytest.approx(200.0, abs=15.0)


def test_arrivals_come_true_when_the_plan_is_driven() -> None:
    """Stops and dwells ahead are in the prediction; each stop's instant is where it is reached."""
    route = route_of(SQUARE, stops_m=[400.0, 1000.0, 1600.0], dwell_s=15.0)
    leg, stand = [10.0] * 40, [0.0] * 15
    speeds = leg + stand + [10.0] * 60 + stand + [10.0] * 60 + stand + [10.0] * 20
    told = follow(EtaCore([route], TUNING), poses(SQUARE, speeds, laps=True))
    reached_s = {"s0": 40, "s1": 115, "s2": 190}
    first = told[5]
    for stop in first.arrivals.stops:
        arrival_s = (stop.arrival_ns - START_NS) / SECOND_NS
        assert arrival_s == pytest.approx(reached_s[stop.stop_id], abs=1.0)
    # the stop where it stands comes on the next lap, and the rest of the dwell counts
    standing = next(one for one in told if one.progress.t_ns == START_NS + 45 * SECOND_NS)
    assert stop_ids(standing) == ["s1", "s2", "s0"]
    arrival_s = (standing.arrivals.stops[0].arrival_ns - START_NS) / SECOND_NS
    assert arrival_s == pytest.approx(115.0, abs=1.5)


def test_the_median_lies_between_early_and_late_and_never_in_the_past() -> None:
    route = route_of(SQUARE, stops_m=[0.0, 5.0, 600.0, 1500.0], dwell_s=5.0)
    drive = poses(SQUARE, [10.0] * 450, noise_m=6.0, laps=True)
    for one in follow(EtaCore([route], TUNING), drive):
        assert len(one.arrivals.stops) == 4
        for stop in one.arrivals.stops:
            assert one.arrivals.t_ns <= stop.early_ns <= stop.arrival_ns <= stop.late_ns


def test_the_followed_route_is_left_only_when_the_vehicle_leaves_it() -> None:
    """Two routes share a street; the vehicle turns off with the second."""
    straight, turning = [(0.0, 0.0), (2000.0, 0.0)], [(0.0, 0.0), (1000.0, 0.0), (1000.0, 800.0)]
    routes = [route_of(straight, route_id="a"), route_of(turning, route_id="b")]
    told = follow(EtaCore(routes, TUNING), poses(turning, [10.0] * 170, noise_m=3.0))
    followed = [name for name, _ in itertools.groupby(one.progress.route_id for one in told)]
    assert followed in (["a", "b"], ["b"])
    assert all(one.progress.route_id == "b" for one in told if one.true_m > 1100.0)
    assert told[-1].progress.distance_m == pytest.approx(told[-1].true_m, abs=15.0)


def test_a_parallel_route_is_not_taken_for_the_nearer_one() -> None:
    near, far = [(0.0, 0.0), (2000.0, 0.0)], [(0.0, 30.0), (2000.0, 30.0)]
    routes = [route_of(far, route_id="far"), route_of(near, route_id="near")]
    told = follow(EtaCore(routes, TUNING), poses(near, [10.0] * 60, noise_m=2.0))
    assert {one.progress.route_id for one in told} == {"near"}


def test_a_route_that_matched_once_is_no_refuge_during_a_detour() -> None:
    """Both match at first; when the followed one is left, the other must match anew."""
    straight, short = [(0.0, 0.0), (2500.0, 0.0)], [(0.0, 10.0), (400.0, 10.0)]
    routes = [route_of(straight, route_id="a"), route_of(short, route_id="b")]
    told = follow(EtaCore(routes, TUNING), poses(DETOUR, [10.0] * 300))
    assert {one.progress.route_id for one in told} == {"a"}
    assert not any(one.progress.on_route for one in told if 720.0 <= one.true_m <= 1920.0)


def test_at_a_terminal_the_route_that_begins_is_preferred_to_the_one_that_ends() -> None:
    east, west = [(0.0, 0.0), (2000.0, 0.0)], [(2000.0, 0.0), (0.0, 0.0)]
    routes = [route_of(east, route_id="east"), route_of(west, route_id="west", stops_m=[700.0])]
    parked = poses(west, [0.0] * 10, headed=False)
    told = follow(EtaCore(routes, TUNING), parked)
    assert {one.progress.route_id for one in told} == {"west"}
    assert stop_ids(told[-1]) == ["s0"]


def test_the_default_core_reads_poses_and_fixes_and_the_reference_fixes() -> None:
    assert make_eta_core([], TUNING).reads == {Pose, GpsFix}
    assert make_eta_core([], Tuning(route_filter="avl")).reads == {GpsFix}


def parked_core() -> tuple[EtaCore, int]:
    line: list[Metres] = [(0, 0), (2000, 0)]
    core = EtaCore([route_of(line, stops_m=[1000.0])], TUNING)
    told = follow(core, poses(line, [10.0] * 30))
    return core, told[-1].progress.t_ns


def test_between_poses_the_place_goes_on_for_two_seconds_at_most() -> None:
    core, last_ns = parked_core()
    [one, _] = core.handle(Tick(last_ns + SECOND_NS), "clock")
    [four, _] = core.handle(Tick(last_ns + 4 * SECOND_NS), "clock")
    assert isinstance(one, Progress)
    assert isinstance(four, Progress)
    assert one.distance_m == pytest.approx(300.0, abs=1.0)
    assert four.distance_m == pytest.approx(310.0, abs=1.0)


def told_at(core: EtaCore, t_ns: int, age_ns: int = 0) -> list[Message]:
    """What a tick brings onto the bus."""
    return [each for each in core.handle(Tick(t_ns, age_ns), "clock") if isinstance(each, Message)]


def test_arrivals_without_a_position_are_told_stale_once_and_then_empty_once() -> None:
    core, last_ns = parked_core()
    found = [
        (age_s, each)
        for age_s in range(1, 400)
        for each in told_at(core, last_ns + age_s * SECOND_NS)
        if isinstance(each, Arrivals)
    ]
    fresh, (stale_s, stale), (empty_s, empty) = found[:-2], found[-2], found[-1]
    assert [(age_s, at.stale, len(at.stops)) for age_s, at in fresh] == [
        (age_s, False, 1) for age_s in range(1, 6)
    ]
    assert (stale_s, stale.stale, len(stale.stops)) == (6, True, 1)
    assert (empty_s, empty.stale, empty.stops) == (361, True, ())
    assert {at.position_ns for _, at in found} == {last_ns}


def test_a_core_that_has_nothing_to_tell_sleeps_until_it_has() -> None:
    core, last_ns = parked_core()
    assert core.handle(Tick(last_ns + 5 * SECOND_NS), "clock")[-1] != Sleep()
    [_, asleep] = core.handle(Tick(last_ns + 6 * SECOND_NS), "clock")
    assert asleep == Sleep(last_ns + 360 * SECOND_NS)
    assert core.handle(Tick(last_ns + 361 * SECOND_NS), "clock")[-1] == Sleep(None)


def test_a_pose_that_was_old_when_it_came_is_stale() -> None:
    core, last_ns = parked_core()
    [arrivals] = told_at(core, last_ns + SECOND_NS, 10 * SECOND_NS)
    assert isinstance(arrivals, Arrivals)
    assert arrivals.stale


def test_a_lost_vehicle_has_no_position() -> None:
    core, last_ns = parked_core()
    lost = Pose(t_ns=last_ns + 10 * SECOND_NS, mode="lost", lat_deg=39.9, lon_deg=-75.35)
    core.handle(lost, "fusion")
    core.handle(Pose(t_ns=last_ns + 10 * SECOND_NS, mode="starting"), "fusion")
    [arrivals] = told_at(core, last_ns + 10 * SECOND_NS)
    assert isinstance(arrivals, Arrivals)
    assert arrivals.stale


def test_nothing_comes_before_a_match_nor_without_routes_nor_between_seconds() -> None:
    far = Pose(t_ns=START_NS, mode="gps", lat_deg=10.0, lon_deg=10.0, speed_mps=5.0)
    for core in (EtaCore([route_of(SQUARE)], TUNING), EtaCore([], TUNING)):
        assert core.handle(Tick(START_NS), "clock") == [Sleep()]
        core.handle(far, "fusion")
        assert core.handle(Tick(START_NS), "clock") == [Sleep()]
    core, last_ns = parked_core()
    assert core.handle(Tick(last_ns + SECOND_NS // 10), "clock") == ()


def test_an_uncertain_pose_far_away_is_not_a_detour() -> None:
    """Dead reckoning drifts 90 m off with a std of 50 m: no evidence of having left the route."""
    core, last_ns = parked_core()
    for second in range(1, 5):
        lat_deg, lon_deg = TOWN.to_geodetic(300.0 + 10.0 * second, 90.0)
        drifted = Pose(
            t_ns=last_ns + second * SECOND_NS,
            mode="dead_reckoning",
            lat_deg=lat_deg,
            lon_deg=lon_deg,
            heading_deg=90.0,
            speed_mps=10.0,
            distance_m=300.0 + 10.0 * second,
            east_std_m=50.0,
            north_std_m=50.0,
        )
        core.handle(drifted, "fusion")
        [progress, arrivals] = core.handle(Tick(drifted.t_ns), "clock")
        assert isinstance(progress, Progress)
        assert progress.on_route
        assert isinstance(arrivals, Arrivals)
        assert arrivals.stops


def test_distance_std_is_the_covariance_along_the_route() -> None:
    line: list[Metres] = [(0, 0), (1000, 1000)]
    core = EtaCore([route_of(line)], TUNING)
    lat_deg, lon_deg = TOWN.to_geodetic(300.0, 300.0)
    for second in range(2):
        pose = Pose(
            t_ns=START_NS + second * SECOND_NS,
            mode="fused",
            lat_deg=lat_deg,
            lon_deg=lon_deg,
            heading_deg=45.0,
            speed_mps=0.0,
            east_std_m=5.0,
            north_std_m=5.0,
            east_north_cov_m2=24.0,
        )
        core.handle(pose, "fusion")
        answers = core.handle(Tick(pose.t_ns), "clock")
    assert isinstance(answers[0], Progress)
    assert answers[0].distance_std_m == pytest.approx(7.0, abs=0.1)  # sqrt(25 + 24)
    assert answers[0].cross_track_m == pytest.approx(0.0, abs=0.5)


def test_the_reference_filter_answers_every_row_of_one_receiver() -> None:
    """Fresh fixes carry their own time, predicted rows a second more; repeats are not believed."""
    route = route_of(SQUARE, stops_m=[0.0, 700.0])
    core = make_eta_core([route], Tuning(route_filter="avl"))

    def row(second: float, north_m: float | None, *, repeat: bool = False) -> GpsFix:
        lat_deg, lon_deg = TOWN.to_geodetic(0.0, north_m or 0.0)
        seen = north_m is not None
        return GpsFix(
            t_ns=START_NS + round(second * SECOND_NS),
            valid=seen,
            repeat=repeat,
            lat_deg=lat_deg if seen else None,
            lon_deg=lon_deg if seen else None,
        )

    assert core.handle(row(0, None), "gps") == []
    rows = [row(1, 100.0), row(2, 110.0), row(2, None, repeat=True), row(2, None), row(5, 135.0)]
    told = [core.handle(one, "gps") for one in rows]
    assert core.handle(row(5, 400.0), "gps-2") == []
    progress = [answers[0] for answers in told if isinstance(answers[0], Progress)]
    assert [(one.t_ns - START_NS) / SECOND_NS for one in progress] == [1, 2, 3, 4, 5]
    distances_m = [one.distance_m for one in progress]
    assert distances_m == pytest.approx([100.0, 110.0, 120.0, 130.0, 137.0], abs=2.0)
    arrivals = told[-1][1]
    assert isinstance(arrivals, Arrivals)
    assert [stop.stop_id for stop in arrivals.stops] == ["s1", "s0"]


def test_the_reference_filter_counts_laps_and_predicts_over_the_start() -> None:
    route = route_of(SQUARE)
    core = make_eta_core([route], Tuning(route_filter="avl"))
    laps = []
    for second, (pose, true_m) in enumerate(poses(SQUARE, [10.0] * 420, laps=True)):
        seen = not 198 <= second <= 203
        fix = GpsFix(
            t_ns=pose.t_ns,
            valid=seen,
            lat_deg=pose.lat_deg if seen else None,
            lon_deg=pose.lon_deg if seen else None,
        )
        [progress, _] = core.handle(fix, "gps")
        assert isinstance(progress, Progress)
        assert progress.lap * route.length_m + progress.distance_m == pytest.approx(true_m, abs=5)
        laps.append(progress.lap)
    assert [lap for lap, _ in itertools.groupby(laps)] == [0, 1, 2]


def test_reports_are_followed_while_fusion_is_away() -> None:
    """A report wakes the core, though the poses made of it would come after it."""
    line: list[Metres] = [(0, 0), (3000, 0)]
    node = eta_node([route_of(line, stops_m=[1000.0, 2000.0])], TUNING)
    told: list[Message] = []
    for second in range(151):
        t_ns = START_NS + second * SECOND_NS
        told += node.advance(t_ns)
        if second % 30 == 0:
            lat_deg, lon_deg = TOWN.to_geodetic(6.0 * second, 0.0)
            fix = GpsFix(t_ns=t_ns, valid=True, lat_deg=lat_deg, lon_deg=lon_deg)
            told += node.take(fix, "gps-ingest")
    arrivals = [one for one in told if isinstance(one, Arrivals) and one.t_ns > START_NS + 10**11]
    assert len(arrivals) > 40
    assert all(one.stops and not one.stale for one in arrivals)
