"""The likeliest place, where there is more than one."""

import msgspec
import pytest

from unit.eta.route_drives import (
    SECOND_NS,
    SPUR,
    SQUARE,
    START_NS,
    TOWN,
    Metres,
    poses,
    route_of,
)
from wayline.matching import matcher
from wayline.messages import Pose
from wayline_eta.place_tracker import Place, PlaceTracker, position_std_m, travelled_between_m


def observe(tracker: PlaceTracker, pose: Pose) -> Place:
    assert pose.lat_deg is not None
    assert pose.lon_deg is not None
    return tracker.observe(pose, pose.lat_deg, pose.lon_deg)


def test_a_tie_is_a_vehicle_that_sets_out() -> None:
    """On a spur's shared ground without a heading: on its way in."""
    [(pose, _)] = poses(SPUR, [0.0], start_m=1200.0, headed=False)
    assert observe(PlaceTracker(route_of(SPUR)), pose).total_m == pytest.approx(1200.0, abs=1.0)


def test_a_wrong_first_guess_is_given_up_when_the_vehicle_moves() -> None:
    """It is on its way out of the spur: the guess would have to go backwards."""
    tracker = PlaceTracker(route_of(SPUR))
    drive = poses(SPUR, [0.0] * 5 + [8.0] * 10, start_m=1500.0, headed=False, noise_m=2.0)
    places_m = [observe(tracker, pose).total_m for pose, _ in drive]
    assert places_m[0] == pytest.approx(1300.0, abs=8.0)
    assert places_m[-1] == pytest.approx(drive[-1][1], abs=8.0)


def test_a_heading_makes_the_first_guess_right() -> None:
    [(pose, _)] = poses(SPUR, [0.0], start_m=1500.0)
    assert observe(PlaceTracker(route_of(SPUR)), pose).total_m == pytest.approx(1500.0, abs=1.0)


def test_a_first_place_just_before_the_start_of_a_loop_is_before_its_first_lap() -> None:
    route = route_of(SQUARE)
    [(pose, _)] = poses(SQUARE, [0.0], start_m=1996.0)
    assert observe(PlaceTracker(route), pose).total_m == pytest.approx(-4.0, abs=0.5)
    [(pose, _)] = poses(SQUARE, [0.0], start_m=1950.0)
    assert observe(PlaceTracker(route), pose).total_m == pytest.approx(1950.0, abs=0.5)


def test_a_short_cut_is_followed_at_once() -> None:
    """A kilometre of the route left out: motion does not fit, but there is only one place."""
    hairpin: list[Metres] = [(0, 0), (600, 0), (600, 300), (0, 300)]
    cut: list[Metres] = [(0, 0), (100, 0), (100, 300), (0, 300)]
    tracker = PlaceTracker(route_of(hairpin))
    places = [observe(tracker, pose) for pose, _ in poses(cut, [10.0] * 46)]
    assert places[8].total_m == pytest.approx(80.0, abs=1.0)
    assert places[-1].total_m == pytest.approx(1450.0, abs=1.0)


def test_dead_reckoning_straight_on_in_a_bend_is_no_short_cut() -> None:
    """The heading kept from before the bend fits a later leg better, 150 m away: no reason."""
    bends: list[Metres] = [(0, 0), (0, -440), (-150, -440), (-150, -1000)]
    tracker = PlaceTracker(route_of(bends))
    for drive_pose, _ in poses(bends, [10.0] * 44):
        observe(tracker, drive_pose)
    for second in range(1, 26):
        lat_deg, lon_deg = TOWN.to_geodetic(0.0, -430.0 - 3.0 * second)
        place = observe(
            tracker,
            Pose(
                t_ns=START_NS + (43 + second) * SECOND_NS,
                mode="dead_reckoning",
                lat_deg=lat_deg,
                lon_deg=lon_deg,
                heading_deg=180.0,
                heading_std_deg=10.0 + second,
                speed_mps=3.0,
                distance_m=430.0 + 3.0 * second,
                east_std_m=4.0 + second,
                north_std_m=4.0 + second,
            ),
        )
    assert place.total_m == pytest.approx(440.0, abs=5.0)


def test_a_short_cut_to_a_street_near_by_is_followed_soon() -> None:
    """The left street stays in reach and fits the motion; position and heading outweigh it."""
    hairpin: list[Metres] = [(0, 0), (600, 0), (600, 150), (0, 150)]
    cut: list[Metres] = [(0, 0), (100, 0), (100, 150), (0, 150)]
    tracker = PlaceTracker(route_of(hairpin))
    places = [observe(tracker, drive_pose) for drive_pose, _ in poses(cut, [10.0] * 33)]
    assert places[8].total_m == pytest.approx(80.0, abs=1.0)
    assert places[30].total_m == pytest.approx(1300.0, abs=1.0)


def test_an_error_that_lasts_for_seconds_is_no_reason_to_jump() -> None:
    """The route passes twice, 20 m apart; for 20 s the position lies nearer the other passage."""
    twice: list[Metres] = [(0, 0), (600, 0), (600, 300), (0, 300), (0, 20), (600, 20)]
    tracker = PlaceTracker(route_of(twice))
    for second, (drive_pose, true_m) in enumerate(poses(twice, [10.0] * 50, noise_m=0.5)):
        north_m = 15.0 if 20 <= second < 40 else 0.0
        lat_deg, lon_deg = TOWN.to_geodetic(10.0 * second, north_m)
        assert tracker.observe(drive_pose, lat_deg, lon_deg).total_m == pytest.approx(true_m, abs=5)


def test_a_fix_after_dead_reckoning_is_news() -> None:
    """Stood still for all it knew, then seen 340 m on, across a hairpin 140 m wide."""
    hairpin: list[Metres] = [(0, 0), (300, 0), (300, -140), (0, -140)]
    tracker = PlaceTracker(route_of(hairpin))

    def seen(second: int, north_m: float, std_m: float) -> float:
        lat_deg, lon_deg = TOWN.to_geodetic(200.0, north_m)
        unmoved = Pose(
            t_ns=START_NS + second * SECOND_NS,
            mode="dead_reckoning",
            speed_mps=0.0,
            east_std_m=std_m,
            north_std_m=std_m,
        )
        return tracker.observe(unmoved, lat_deg, lon_deg).total_m

    for second in range(30):
        assert seen(second, 0.0, 4.0 + 2.0 * second) == pytest.approx(200.0, abs=0.1)
    assert seen(30, -140.0, 4.0) == pytest.approx(540.0, abs=0.5)


@pytest.mark.parametrize(("more_m", "is_second"), [(650.0, True), (1300.0, False)])
def test_over_a_kilometre_the_odometer_may_err_by_more_than_over_a_few_metres(
    more_m: float, is_second: bool
) -> None:
    """A street passed twice, 20 m apart: the position says the second time, the distance the first.

    With `more_m` between the passages, 1 km of travel leaves room for 650 m, not for 1300 m.
    """
    detour_m = (more_m - 380.0) / 2.0
    twice: list[Metres] = [
        (0, 0), (1100, 0), (1100, detour_m), (900, detour_m), (900, 20), (2000, 20),
    ]  # fmt: skip
    tracker = PlaceTracker(route_of(twice))
    [(start, _)] = poses(twice, [10.0])
    observe(tracker, start)
    lat_deg, lon_deg = TOWN.to_geodetic(1000.0, 20.0)
    later = msgspec.structs.replace(start, t_ns=start.t_ns + 100 * SECOND_NS, distance_m=1000.0)
    place = tracker.observe(later, lat_deg, lon_deg)
    assert place.total_m == pytest.approx(1000.0 + (more_m if is_second else 0.0), abs=1.0)


def pose(distance_m: float, speed_mps: float | None, t_s: int = 0) -> Pose:
    return Pose(t_ns=t_s * 10**9, mode="fused", distance_m=distance_m, speed_mps=speed_mps)


@pytest.mark.parametrize(
    ("last", "now", "moved_m"),
    [
        (pose(100.0, 5.0), pose(107.0, 6.0, 1), 7.0),
        (pose(100.0, 5.0), pose(103.0, -2.0, 1), -3.0),  # reversing: the distance still grows
        (pose(900.0, 5.0), pose(4.0, 6.0, 2), 12.0),  # fusion has started anew
        (pose(100.0, None), pose(107.0, None, 1), 7.0),
    ],
)
def test_travelled_distance_has_the_sign_of_the_speed(
    last: Pose, now: Pose, moved_m: float
) -> None:
    assert travelled_between_m(last, now) == pytest.approx(moved_m)


def test_position_std_follows_the_axis_of_the_covariance() -> None:
    known = Pose(t_ns=0, mode="fused", east_std_m=5.0, north_std_m=5.0, east_north_cov_m2=24.0)
    assert position_std_m(known, 45.0) == pytest.approx(7.0)
    assert position_std_m(known, 135.0) == pytest.approx(1.0)
    assert position_std_m(known, None) == pytest.approx(5.0)
    assert position_std_m(Pose(t_ns=0, mode="gps"), 45.0) == 5.0


CIRCULAR: list[Metres] = [(0, 0), (0, 500), (500, 500), (500, 0), (1, 0)]


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_a_vehicle_that_waits_where_a_circular_trip_begins_is_not_at_its_end(seed: int) -> None:
    """Ten minutes of noise, of a pose that points the way it came, tell nothing."""
    tracker = PlaceTracker(route_of(CIRCULAR))
    for drive_pose, _ in poses(CIRCULAR, [0.0] * 600, noise_m=3.0, seed=seed):
        pointing = msgspec.structs.replace(drive_pose, heading_deg=270.0, speed_mps=0.1)
        place = observe(tracker, pointing)
    assert place.total_m < 30.0


def test_a_vehicle_first_seen_just_before_the_end_of_a_loop_is_there() -> None:
    """Twenty metres before it begins its next lap."""
    [(pose, _)] = poses(SQUARE, [10.0], start_m=1980.0)
    assert observe(PlaceTracker(route_of(SQUARE)), pose).total_m == pytest.approx(1980.0, abs=0.5)


COIL: list[Metres] = [(0, 0), (0, 500), (500, 500), (500, 0)] * 20


@pytest.mark.parametrize("ending", [[(0, 0)], [(300, 0), (300, 900)]], ids=["loop", "open"])
@pytest.mark.parametrize("expected_m", [None, 12.0], ids=["poses", "reports"])
def test_a_street_that_is_passed_twenty_times_is_weighed_as_one_that_is_passed_twice(
    monkeypatch: pytest.MonkeyPatch, ending: list[Metres], expected_m: float | None
) -> None:
    """All ways from passage to passage at once or one by one: the same to the last bit."""
    drive = poses(COIL, [10.0] * 40 + [0.0] * 10, noise_m=5.0, start_m=15_000.0)

    def tracked() -> list[Place]:
        tracker = PlaceTracker(route_of([*COIL, *ending]))
        return [
            tracker.observe(pose, pose.lat_deg or 0.0, pose.lon_deg or 0.0, expected_m)
            for pose, _ in drive
        ]

    at_once = tracked()
    monkeypatch.setattr(matcher, "MANY_WAYS", 1_000_000)
    assert tracked() == at_once
