"""How far a trip went, from the messages that a vehicle sends."""

import msgspec
import numpy as np
import pytest

from builders import at, odometer
from unit.trip_distance.journeys import Leg, journey, metered, moved, with_hole
from wayline.line import Line
from wayline.messages import GpsFix, Odometer, Pose
from wayline.trip_distance.track import track_of
from wayline.trip_distance.trip import TripMeter
from wayline.tuning import Tuning

STRAIGHT = [Leg(601, 70.0, 15.0)]
"""9 km."""
CORNER = [Leg(120, 0.0, 12.0), Leg(121, 90.0, 12.0)]


def test_speeds_are_added_up_whatever_positions_do() -> None:
    told = metered(journey(STRAIGHT, position_std_m=3.0, speed_std_mps=0.1))
    assert told.basis == "speeds"
    assert told.distance_m == pytest.approx(9_000.0, abs=9.0)
    assert 4.0 < told.distance_std_m < 20.0


def test_without_speeds_positions_are_smoothed() -> None:
    """Steps from fix to fix would make 9.5 km of it."""
    told = metered(journey(STRAIGHT, position_std_m=1.0, tells_speed=False))
    assert told.basis == "positions"
    assert told.distance_m == pytest.approx(9_000.0, rel=0.005)


@pytest.mark.parametrize("tells_speed", [True, False], ids=["speeds", "positions"])
def test_standing_adds_nothing(*, tells_speed: bool) -> None:
    legs = [Leg(301, 70.0, 15.0), Leg(600, 70.0, 0.0)]
    moving = metered(journey(legs[:1], tells_speed=tells_speed))
    told = metered(journey(legs, position_std_m=0.3, speed_std_mps=0.05, tells_speed=tells_speed))
    # the second in which it brakes
    assert told.distance_m - moving.distance_m == pytest.approx(7.5, abs=8.0)


def test_a_poor_receivers_noise_at_rest_adds_nothing() -> None:
    """Ten minutes of 0.2 m/s that lead nowhere: 120 m by speeds."""
    slowing = [Leg(300, 70.0, 15.0), *(Leg(1, 70.0, speed) for speed in (12.0, 9.0, 6.0, 3.0))]
    at_once, long_after = (
        metered(journey([*slowing, Leg(rest, 70.0, 0.0)], position_std_m=1.5, speed_std_mps=0.25))
        for rest in (35, 600)
    )
    assert long_after.distance_m - at_once.distance_m == pytest.approx(0.0, abs=3.0)


def test_creeping_is_a_way() -> None:
    """In a queue at 0.6 m/s."""
    told = metered(journey([Leg(301, 70.0, 0.6)], position_std_m=1.0, speed_std_mps=0.03))
    assert told.distance_m == pytest.approx(180.0, abs=4.0)


@pytest.mark.parametrize("tells_speed", [True, False], ids=["speeds", "positions"])
def test_reflections_add_nothing(*, tells_speed: bool) -> None:
    fixes = journey(STRAIGHT, tells_speed=tells_speed)
    for second in (100, 101, 102, 350, 500):
        fixes[second] = moved(fixes[second], 0.0007)
    assert metered(fixes).distance_m == pytest.approx(9_000.0, rel=0.002)


def test_a_speed_that_no_vehicle_has_adds_nothing() -> None:
    fixes = journey(STRAIGHT)
    fixes[300] = msgspec.structs.replace(fixes[300], speed_mps=90.0)
    assert metered(fixes).distance_m == pytest.approx(9_000.0, abs=3.0)


def test_a_straight_hole_is_as_long_as_its_chord() -> None:
    """Though the vehicle waited in it for a minute, and speed tells nothing of that."""
    legs = [Leg(100, 70.0, 15.0), Leg(60, 70.0, 0.0), Leg(100, 70.0, 15.0)]
    told = metered(with_hole(journey(legs), 80, 180))
    assert told.distance_m == pytest.approx(199 * 15.0, abs=10.0)
    assert told.bridged_m == pytest.approx(41 * 15.0, abs=10.0)


def test_a_hole_round_a_corner_is_longer_than_its_chord() -> None:
    """480 m round the corner, 339 m straight."""
    fixes = with_hole(journey(CORNER), 101, 140)
    told = metered(fixes)
    assert abs(told.distance_m - 240 * 12.0) < 2.0 * told.distance_std_m
    assert told.distance_m == pytest.approx(240 * 12.0, abs=40.0)


def test_a_hole_along_a_route_is_as_long_as_the_route() -> None:
    """A detour of 2.4 km that no direction tells of, with a long wait in it."""
    legs = [Leg(100, 90.0, 12.0), Leg(100, 0.0, 12.0), Leg(60, 90.0, 12.0), Leg(100, 180.0, 12.0)]
    fixes = journey([*legs, Leg(101, 90.0, 12.0)])
    waited = [
        msgspec.structs.replace(each, t_ns=each.t_ns + 300_000_000_000 * (number > 200))
        for number, each in enumerate(fixes)
    ]
    route = Line(
        *(np.array([getattr(each, name) for each in fixes]) for name in ("lat_deg", "lon_deg"))
    )
    told = metered(with_hole(waited, 90, 371), route=route)
    assert told.distance_m == pytest.approx(460 * 12.0, rel=0.005)
    assert told.distance_std_m < 30.0
    assert metered(with_hole(waited, 90, 371)).distance_std_m > 100.0


def test_fixes_of_few_satellites_end_no_hole() -> None:
    """Before they are lost and after, positions are 500 km off and speeds 5 m/s."""
    fixes = journey(STRAIGHT)
    for second in (*range(190, 200), *range(240, 250)):
        fixes[second] = moved(fixes[second], 5.0, satellites=3, speed_mps=20.0)
    told = metered(with_hole(fixes, 200, 240))
    assert told.distance_m == pytest.approx(9_000.0, rel=0.005)
    assert told.bridged_m == pytest.approx(61 * 15.0, rel=0.02)


def test_a_reflection_at_its_end_makes_no_hole_longer() -> None:
    """Of 78 m, to the side."""
    fixes = journey(STRAIGHT)
    for second in range(240, 245):
        fixes[second] = moved(fixes[second], 0.0007)
    told = metered(with_hole(fixes, 235, 240))
    assert told.distance_m == pytest.approx(9_000.0, abs=20.0)


def test_wheels_get_their_scale_from_fixes_and_tell_the_rest() -> None:
    """They read 3 % high, roll half a minute before the first fix and through a hole."""
    fixes = with_hole(journey(STRAIGHT), 200, 400)[30:]
    wheels = [odometer(0.1 * tenth, 15.0 * 1.03) for tenth in range(6_001)]
    told = metered(sorted([*fixes, *wheels], key=lambda each: each.t_ns))
    assert told.basis == "wheels"
    assert told.distance_m == pytest.approx(9_000.0, abs=9.0)
    assert told.bridged_m == 0.0


def test_a_distance_in_frames_of_its_own_takes_nothing_from_the_speeds() -> None:
    """Ten speeds a second, and a counter beside them in messages without a speed."""
    wheels = [odometer(0.1 * tenth, 15.0) for tenth in range(6_001)]
    counted = [Odometer(t_ns=at(n + 0.05), distance_m=5.0 * (3 * n)) for n in range(600)]
    told = metered(sorted([*wheels, *counted], key=lambda each: each.t_ns))
    assert told.distance_m == pytest.approx(9_000.0, abs=2.0)


def test_where_wheels_are_silent_gps_tells() -> None:
    fixes = journey(STRAIGHT)
    wheels = [odometer(second, 15.0 * 0.98) for second in range(601) if not 100 < second < 300]
    told = metered(sorted([*fixes, *wheels], key=lambda each: each.t_ns))
    assert told.distance_m == pytest.approx(9_000.0, abs=12.0)


def test_wheels_alone_are_believed_as_they_read() -> None:
    told = metered([odometer(0.5 * half, 10.0) for half in range(201)])
    assert told.distance_m == pytest.approx(1_000.0)
    assert told.distance_std_m == pytest.approx(20.0, abs=1.0)
    assert told.doubts == ("no fix measures the wheels",)


def test_poses_count_where_wheels_are_in_them() -> None:
    fixes = with_hole(journey(CORNER), 101, 140)
    poses = [
        Pose(
            t_ns=at(second),
            mode="fused" if second < 101 else "dead_reckoning",
            distance_m=12.0 * second,
        )
        for second in range(241)
    ]
    told = metered(sorted([*fixes, *poses], key=lambda each: each.t_ns))
    assert told.basis == "wheels"
    assert told.distance_m == pytest.approx(2_880.0, abs=4.0)


def test_poses_of_gps_alone_do_not() -> None:
    fixes = journey(STRAIGHT)
    poses = [Pose(t_ns=each.t_ns, mode="gps", distance_m=99.0 * n) for n, each in enumerate(fixes)]
    assert metered([*fixes, *poses]).basis == "speeds"


def test_speeds_in_knots_taken_as_metres_a_second_are_noticed() -> None:
    fixes = [
        msgspec.structs.replace(each, speed_mps=(each.speed_mps or 0.0) / 0.514444)
        for each in journey(STRAIGHT, position_std_m=0.5)
    ]
    told = metered(fixes)
    assert told.distance_m == pytest.approx(9_000.0, rel=0.005)
    assert told.doubts == ("speeds are 1.94 times what positions say: knots taken as m/s",)


def test_three_fixes_are_a_trip() -> None:
    assert metered(journey([Leg(3, 0.0, 10.0)])).distance_m == pytest.approx(20.0, abs=0.5)


def test_one_fix_is_no_trip() -> None:
    meter = TripMeter()
    meter.take(journey([Leg(1, 0.0, 10.0)])[0])
    assert meter.distance() is None


def test_bad_fixes_alone_are_told_and_widen_the_std() -> None:
    good, bad = (metered(journey(STRAIGHT, satellites=count)) for count in (7, 3))
    assert bad.doubts == ("no fix is good",)
    assert bad.distance_std_m > good.distance_std_m


def test_bad_fixes_alone_tell_a_distance_without_speeds_too() -> None:
    """Corners that no car takes at 12 m/s are cut by 3 %."""
    corners = [Leg(20, 90.0 * (number % 2), 12.0) for number in range(30)]
    told = metered(journey(corners, satellites=3, tells_speed=False))
    assert told.basis == "positions"
    assert told.distance_m == pytest.approx(599 * 12.0, rel=0.05)


def test_time_that_goes_back_is_counted_and_left_out() -> None:
    meter = TripMeter()
    fixes = journey(STRAIGHT)
    for each in [*fixes, *fixes[200:300], GpsFix(t_ns=at(999.0), valid=False)]:
        meter.take(each)
    told = meter.distance()
    assert told is not None
    assert told.distance_m == pytest.approx(9_000.0, abs=3.0)
    assert meter.late == 100


def test_a_trip_round_the_date_line_is_as_long_as_elsewhere() -> None:
    fixes = [
        msgspec.structs.replace(each, lon_deg=((each.lon_deg or 0.0) + 349.95) % 360.0 - 180.0)
        for each in journey(STRAIGHT, tells_speed=False)
    ]
    assert {(each.lon_deg or 0.0) > 0.0 for each in fixes} == {True, False}
    assert metered(fixes).distance_m == pytest.approx(9_000.0, rel=0.001)


def test_a_leap_of_half_a_continent_and_back_leaves_no_trace() -> None:
    """Meridians meet: there and back have other bearings, and add up to nothing all the same."""
    fixes = journey(STRAIGHT)
    leap = msgspec.structs.replace(fixes[300], lat_deg=50.0, lon_deg=25.0)
    track = track_of([*fixes[:300], leap, *fixes[301:]], Tuning())
    straight_m = np.linalg.norm(track.places_m[-1] - track.places_m[0])
    assert straight_m == pytest.approx(9_000.0, abs=5.0)
