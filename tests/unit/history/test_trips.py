"""Trips: where they begin and end, how long they are, what counts and what does not."""

import random
from collections.abc import Iterable

import msgspec
import pytest

from builders import at
from unit.history.driven import VEHICLE, kept_of, legs, pose
from wayline.core import Sleep
from wayline.inputs import Tick
from wayline.messages import GpsFix, Message, Pose, Torque, Trip
from wayline_history.climb import Climb
from wayline_history.core import HistoryCore
from wayline_history.samples import fix_of
from wayline_history.travelled import SourcedFix
from wayline_history.trip_cutter import ENGINE_OFF_NS, PARK_NS, SILENCE_NS

PARK_S, OFF_S, SILENCE_S = PARK_NS * 1e-9, ENGINE_OFF_NS * 1e-9, SILENCE_NS * 1e-9


def trips_of(messages: Iterable[Message]) -> list[Trip]:
    return kept_of(messages).trips


def test_a_drive_between_two_parks_is_a_trip() -> None:
    (trip,) = trips_of(legs((60, 0.0), (100, 10.0), (PARK_S + 10, 0.0)))
    assert (trip.started_ns, trip.ended_ns) == (at(59), at(160))
    assert trip.distance_m == pytest.approx(1000.0, abs=0.1)
    assert trip.moving_s == pytest.approx(101.0)
    assert trip.max_speed_mps == 10.0
    assert trip.trip_key == f"{VEHICLE}_20231114T221419Z"
    assert trip.t_ns == trip.ended_ns


def test_a_light_is_a_stop_on_the_way() -> None:
    (trip,) = trips_of(legs((50, 10.0), (40, 0.0), (50, 10.0)))
    (stop,) = trip.stops
    assert (stop.started_ns, stop.dwell_s) == (at(50), 40.0)


def test_a_moment_is_no_stop() -> None:
    (trip,) = trips_of(legs((50, 10.0), (5, 0.0), (50, 10.0)))
    assert trip.stops == ()


def test_a_park_cuts_one_trip_from_the_next() -> None:
    drive = legs((50, 10.0), (PARK_S + 5, 0.0), (50, 10.0))
    first, second = trips_of(drive)
    assert first.ended_ns == at(50)
    assert second.started_ns == at(50 + PARK_S + 4)


def test_silence_cuts_where_it_was_last_heard() -> None:
    drive = [*legs((50, 10.0)), *legs((50, 10.0), start_s=51 + SILENCE_S)]
    first, second = trips_of(drive)
    assert first.ended_ns == at(49)
    assert second.started_ns == at(51 + SILENCE_S)


def test_a_trip_ends_by_time_alone_when_nothing_more_comes() -> None:
    core = HistoryCore(VEHICLE)
    for each in legs((50, 10.0)):
        core.handle(each, "fusion")
    assert not [
        each for each in core.handle(Tick(at(49 + SILENCE_S)), "") if isinstance(each, Trip)
    ]
    outputs = core.handle(Tick(at(60 + SILENCE_S)), "history")
    (trip,) = [each for each in outputs if isinstance(each, Trip)]
    assert trip.ended_ns == at(49)
    assert any(isinstance(each, Sleep) for each in outputs)


def engine(seconds: float, rpm: float) -> Torque:
    return Torque(t_ns=at(seconds), engine_speed_rpm=rpm)


def test_an_engine_that_is_off_ends_a_trip_sooner() -> None:
    drive: list[Message] = [engine(0, 900.0), *legs((50, 10.0))]
    drive += [engine(50, 0.0), *(pose(50 + second, 500, 0.0) for second in range(int(OFF_S) + 5))]
    drive += [engine(60 + OFF_S, 900.0)]
    drive += [pose(60 + OFF_S + second, 500 + 10 * second, 10.0) for second in range(50)]
    first, second = trips_of(drive)
    assert first.ended_ns == at(50)
    assert second.started_ns == at(54 + OFF_S)


def test_an_engine_that_stops_at_lights_ends_none() -> None:
    drive: list[Message] = [*legs((50, 10.0)), engine(50, 0.0)]
    drive += [pose(50 + second, 500, 0.0) for second in range(60)]
    drive += [engine(110, 900.0), *(pose(110 + s, 500 + 10 * s, 10.0) for s in range(50))]
    assert len(trips_of(drive)) == 1


def test_a_vehicle_that_is_shunted_makes_no_trip() -> None:
    assert trips_of(legs((60, 0.0), (9, 10.0), (400, 0.0))) == []


def test_positions_that_wander_make_no_trip() -> None:
    chance = random.Random(1)
    wander = [
        pose(s, 20 * chance.gauss(), abs(chance.gauss()) * 2, distance_m=2.0 * s)
        for s in range(900)
    ]
    assert trips_of(wander) == []


def test_a_loop_that_ends_where_it_began_is_a_trip() -> None:
    out = [pose(s, 10.0 * s, 10.0) for s in range(50)]
    back = [pose(50 + s, 500 - 10.0 * s, 10.0, distance_m=500 + 10.0 * s) for s in range(51)]
    (trip,) = trips_of([*out, *back])
    assert trip.distance_m == pytest.approx(1000.0, abs=0.1)


def test_fusion_that_counts_anew_costs_no_distance() -> None:
    before = [pose(s, 10.0 * s, 10.0) for s in range(50)]
    after = [pose(50 + s, 500 + 10.0 * s, 10.0, distance_m=10.0 * s) for s in range(50)]
    (trip,) = trips_of([*before, *after])
    assert trip.distance_m == pytest.approx(990.0, rel=0.002)


def test_what_came_late_or_twice_changes_no_trip() -> None:
    drive = list(legs((60, 0.0), (100, 10.0), (20, 0.0)))
    (straight,) = trips_of(drive)
    mixed = [*drive[:80], drive[70], drive[79], *drive[80:]]
    assert trips_of(mixed) == [straight]


def test_refusals_and_outages_are_counted_but_not_of_the_park() -> None:
    lost = [pose(50 + s, 500 + 10.0 * s, 10.0, mode="dead_reckoning") for s in range(10)]
    parked = [pose(60 + s, 600, 0.0, mode="dead_reckoning") for s in range(320)]
    (trip,) = trips_of([*legs((50, 10.0)), *lost, *parked])
    assert trip.outage_s == pytest.approx(11.0)


def test_a_core_that_was_started_anew_goes_on_with_the_trip() -> None:
    drive = list(legs((60, 0.0), (100, 10.0), (PARK_S + 10, 0.0)))
    (whole,) = trips_of(drive)
    before = kept_of(drive[:120])
    after = kept_of(drive[120:], known=before.rows("fused"))
    assert before.trips[0].trip_key == whole.trip_key
    assert after.trips == [whole]


def test_a_jitter_of_the_altitude_is_no_climb() -> None:
    chance = random.Random(3)
    climb = Climb()
    for second in range(3600):
        climb.take(at(second), 500.0 + 2.0 * chance.gauss(), 3.0)
    assert climb.known[0] == 0.0


def test_a_hill_is_climbed_once_whatever_the_jitter() -> None:
    chance = random.Random(3)
    climb = Climb()
    for second in range(2000):
        hill_m = 100.0 * min(second, 2000 - second) / 1000.0
        climb.take(at(second), 500.0 + hill_m + chance.gauss(), 1.5)
    up_m, std_m = climb.known
    assert std_m is not None
    assert up_m == pytest.approx(100.0, abs=3 * std_m)
    assert up_m is not None
    assert up_m > 95.0


def test_without_altitudes_the_climb_is_unknown() -> None:
    (trip,) = trips_of([pose(s, 10.0 * s, 10.0, alt_m=None, alt_std_m=None) for s in range(60)])
    assert (trip.climb_m, trip.climb_std_m) == (None, None)


def test_a_pose_of_unknown_place_makes_nothing() -> None:
    unknown = [Pose(t_ns=at(s), mode="starting") for s in range(60)]
    assert trips_of(unknown) == []


def test_a_trip_under_way_is_kept_as_far_as_it_has_come() -> None:
    kept = kept_of(legs((700, 10.0)), finish=False)
    told = [piece.under_way for piece in kept.pieces if piece.under_way is not None]
    assert kept.trips == []
    assert {trip.started_ns for trip in told} == {at(0)}
    lasted_s = [(trip.ended_ns - trip.started_ns) * 1e-9 for trip in told]
    assert lasted_s[0] < 60.0
    assert len(lasted_s) == 5
    assert lasted_s[-1] > 600.0
    assert lasted_s == sorted(lasted_s)


def with_fixes(poses: Iterable[Pose], *, without: range = range(0)) -> list[Message]:
    """Poses of GPS that count a tenth too much, after the fixes that they were made of."""
    drive: list[Message] = []
    for second, each in enumerate(poses):
        if second not in without:
            fix = GpsFix(
                t_ns=each.t_ns,
                valid=True,
                lat_deg=each.lat_deg,
                lon_deg=each.lon_deg,
                speed_mps=each.speed_mps,
                course_deg=90.0,
                mode=3,
                fix="gps",
                satellites=9,
                hdop=1.0,
                pdop=2.0,
            )
            drive.append(fix)
        counted_m = 1.1 * each.distance_m
        drive.append(msgspec.structs.replace(each, mode="gps", distance_m=counted_m))
    return drive


def test_fixes_tell_how_far_a_trip_without_wheels_went() -> None:
    (trip,) = trips_of(with_fixes(legs((60, 0.0), (100, 10.0), (PARK_S + 10, 0.0))))
    assert trip.distance_m == pytest.approx(1000.0, abs=10.0)
    assert 1.0 < trip.distance_std_m < 10.0


def test_a_hole_of_the_fixes_is_bridged_and_told_by_the_std() -> None:
    whole, holed = (
        trips_of(with_fixes(legs((60, 0.0), (200, 10.0), (PARK_S + 10, 0.0)), without=without))[0]
        for without in (range(0), range(120, 180))
    )
    assert holed.distance_m == pytest.approx(2000.0, abs=20.0)
    assert holed.distance_std_m > whole.distance_std_m


def test_a_long_trip_is_summed_up_in_stretches() -> None:
    (trip,) = trips_of(with_fixes(legs((10, 0.0), (3000, 15.0), (PARK_S + 10, 0.0))))
    assert trip.distance_m == pytest.approx(45_000.0, abs=50.0)


def test_of_two_receivers_one_counts() -> None:
    core = HistoryCore(VEHICLE)
    kept: list[object] = []
    for each in with_fixes(legs((10, 0.0), (100, 10.0), (PARK_S + 10, 0.0))):
        kept += core.handle(each, "gps-ingest")
        if isinstance(each, GpsFix) and each.lat_deg is not None:
            other = msgspec.structs.replace(each, t_ns=each.t_ns + 1, lat_deg=each.lat_deg + 1e-4)
            kept += core.handle(other, "gps-ingest-2")
    (trip,) = [each for each in kept if isinstance(each, Trip)]
    assert trip.distance_m == pytest.approx(1000.0, abs=10.0)


def test_a_trip_that_is_gone_on_with_has_the_fixes_of_before() -> None:
    drive = with_fixes(legs((10, 0.0), (100, 10.0), (100, 12.0), (PARK_S + 10, 0.0)))
    (whole,) = trips_of(drive)
    before = kept_of(drive[:240], finish=True)
    fixes = [SourcedFix("test", fix_of(row)) for row in before.rows("raw")]
    after = kept_of(drive[240:], known=before.rows("fused"), fixes=fixes)
    assert [trip for trip in after.trips if trip.trip_key == whole.trip_key] == [whole]
