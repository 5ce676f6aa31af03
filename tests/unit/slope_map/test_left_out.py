"""What of a drive teaches no road is told: from where to where, when, and why."""

from collections.abc import Callable

import msgspec
import pytest

from unit.slope_map.hilly_road import SECOND_NS, START_NS, core, drive, driven_of
from wayline.inputs import Flush
from wayline.messages import Barometer, GpsFix, Odometer, Pose, Torque
from wayline.tuning import Tuning
from wayline.vertical.driveline import REVERSED, UNJOINED
from wayline.vertical.plausible import NO_SUCH_AIR
from wayline.vertical.trust import NO_SUCH_MASS
from wayline_slope_map.left_out import (
    HARDLY_KNOWN,
    LEAPT,
    NO_HEIGHT,
    NO_ROAD,
    NOT_ON_EARTH,
    UNPLACED,
    UNSURE,
    WALKED,
    LeftOut,
    Span,
    Spans,
)
from wayline_slope_map.run import outcome

LENGTH_M = 3_000.0
Edit = Callable[[msgspec.Struct], msgspec.Struct]


def left_out_of(messages: list[msgspec.Struct], tuning: Tuning | None = None) -> list[LeftOut]:
    """Of a whole drive: while it was driven, and when it was smoothed."""
    driving = core(tuning=tuning)
    records = [each for message in messages for each in driving.handle(message, "test")]
    at_once = [record for record in records if isinstance(record, LeftOut)]
    smoothed = [
        each for driven in driven_of(core(tuning=tuning), messages) for each in outcome(driven)
    ]
    return at_once + [each for each in smoothed if isinstance(each, LeftOut)]


def edited(edit: Edit) -> list[msgspec.Struct]:
    return [edit(message) for message in drive(seed=3, length_m=LENGTH_M)]


def in_the_middle(**changes: object) -> list[msgspec.Struct]:
    """Poses that are otherwise from 1000 m to 1500 m."""

    def edit(message: msgspec.Struct) -> msgspec.Struct:
        is_there = isinstance(message, Pose) and 1_000.0 <= message.distance_m <= 1_500.0
        return msgspec.structs.replace(message, **changes) if is_there else message

    return edited(edit)


@pytest.mark.parametrize(
    "changes",
    [
        pytest.param({"mode": "lost"}, id="lost"),
        pytest.param({"east_std_m": 90.0}, id="unsure"),
        pytest.param({"lat_deg": None, "lon_deg": None, "mode": "starting"}, id="not yet found"),
    ],
)
def test_a_stretch_without_a_position_is_told_with_the_places_beside_it(
    changes: dict[str, object],
) -> None:
    (part,) = left_out_of(in_the_middle(**changes))
    assert (part.sensor, part.reason, part.vehicle_id) == (None, UNPLACED, "car")
    assert part.length_m == pytest.approx(500.0, abs=3.0)
    assert (part.start_ns - START_NS) / SECOND_NS == pytest.approx(1_000.0 / 15.0, abs=0.2)
    assert (part.end_ns - START_NS) / SECOND_NS == pytest.approx(1_500.0 / 15.0, abs=0.2)
    places = part.start_lat_deg, part.start_lon_deg, part.end_lat_deg, part.end_lon_deg
    assert None not in places
    assert part.start_lon_deg != part.end_lon_deg


def test_what_is_shorter_than_a_hundred_metres_is_not_told() -> None:
    def edit(message: msgspec.Struct) -> msgspec.Struct:
        is_there = isinstance(message, Pose) and 1_000.0 <= message.distance_m <= 1_090.0
        return msgspec.structs.replace(message, mode="lost") if is_there else message

    assert left_out_of(edited(edit)) == []


@pytest.mark.parametrize(
    ("kind", "changes", "sensor", "reason"),
    [
        (Barometer, {"pressure_pa": 1013.2}, "barometer", NO_SUCH_AIR),
        (GpsFix, {"alt_m": 20_000.0}, "gps", NOT_ON_EARTH),
        (GpsFix, {"v_std_m": 80.0}, "gps", HARDLY_KNOWN),
    ],
)
def test_a_sensor_that_is_not_used_is_named(
    kind: type[msgspec.Struct], changes: dict[str, object], sensor: str, reason: str
) -> None:
    def edit(message: msgspec.Struct) -> msgspec.Struct:
        return msgspec.structs.replace(message, **changes) if type(message) is kind else message

    (part,) = left_out_of(edited(edit))
    assert (part.sensor, part.reason) == (sensor, reason)
    assert part.length_m == pytest.approx(LENGTH_M, abs=40.0)


def engine(t_ns: int, **changes: object) -> list[msgspec.Struct]:
    wheels = Odometer(t_ns=t_ns, speed_mps=15.0, reverse=bool(changes.pop("reverse", False)))
    torque = Torque(t_ns=t_ns, engine_torque_nm=200.0 + t_ns % 7, engine_speed_rpm=1500.0)
    return [wheels, msgspec.structs.replace(torque, **changes)]


@pytest.mark.parametrize(
    ("changes", "reason"),
    [
        ({"gear": 0}, UNJOINED),
        ({"clutch": True}, UNJOINED),
        ({"gear": -1}, REVERSED),
        ({"reverse": True}, REVERSED),
        ({"gear": 4}, None),
    ],
)
def test_torque_that_tells_nothing_says_why(changes: dict[str, object], reason: str | None) -> None:
    messages = []
    for message in drive(seed=3, length_m=LENGTH_M):
        if isinstance(message, Pose):
            is_there = 1_000.0 <= message.distance_m <= 1_500.0
            messages += engine(message.t_ns, **(dict(changes) if is_there else {}))
        messages.append(message)
    # the engine's mass is made up
    parts = [each for each in left_out_of(messages) if each.reason != NO_SUCH_MASS]
    told = [(each.sensor, each.reason) for each in parts]
    assert told == ([] if reason is None else [("torque", reason)])


def test_a_leap_is_told_with_both_its_ends() -> None:
    def edit(message: msgspec.Struct) -> msgspec.Struct:
        if not isinstance(message, Pose) or message.distance_m < 1_500.0:
            return message
        return msgspec.structs.replace(message, lat_deg=(message.lat_deg or 0.0) + 0.045)

    (part,) = left_out_of(edited(edit))
    assert part.reason == LEAPT
    assert (part.end_lat_deg or 0.0) - (part.start_lat_deg or 0.0) == pytest.approx(0.045, abs=1e-3)
    assert part.length_m < 30.0


def test_what_was_reckoned_before_a_leap_teaches_nothing() -> None:
    """No fix was believed on the way, and it led astray: the wheels were right, the place not."""

    def edit(message: msgspec.Struct) -> msgspec.Struct:
        if not isinstance(message, Pose) or message.distance_m < 1_000.0:
            return message
        if message.distance_m < 1_500.0:
            return msgspec.structs.replace(message, mode="dead_reckoning")
        return msgspec.structs.replace(message, lat_deg=(message.lat_deg or 0.0) + 0.045)

    (part,) = left_out_of(edited(edit))
    assert (part.reason, part.sensor) == (LEAPT, None)
    assert part.length_m == pytest.approx(510.0, abs=15.0)
    first, _ = driven_of(core(), edited(edit))
    bins = [
        each.bin_index
        for run in outcome(first)
        if not isinstance(run, LeftOut)
        for each in run.bins
    ]
    assert max(bins) * 20.0 == pytest.approx(1_000.0, abs=30.0)


def test_a_run_that_told_no_height_is_told() -> None:
    poses = [each for each in edited(lambda each: each) if isinstance(each, Pose)]
    (part,) = left_out_of([*poses, Flush(poses[-1].t_ns)])
    assert (part.reason, part.sensor) == (NO_HEIGHT, None)
    assert part.length_m == pytest.approx(LENGTH_M, abs=10.0)


def test_a_drive_round_and_round_a_yard_is_no_road() -> None:
    """Every place is known at once, none lies 100 m along the way from another."""

    def edit(message: msgspec.Struct) -> msgspec.Struct:
        if not isinstance(message, Pose):
            return message
        turn_deg = 360.0 * (message.distance_m / 50.0) % 360.0
        return msgspec.structs.replace(message, lat_deg=55.9, lon_deg=9.8, heading_deg=turn_deg)

    reasons = {part.reason for part in left_out_of(edited(edit))}
    assert reasons == {NO_ROAD}


def test_a_stretch_at_a_walking_pace_is_told_with_the_road_beside_it() -> None:
    slow = drive(seed=3, length_m=400.0, speed_mps=2.0)
    (part,) = (each for each in left_out_of(slow) if each.reason == WALKED)
    assert part.length_m == pytest.approx(400.0, abs=25.0)


def test_a_grade_that_is_hardly_known_is_told() -> None:
    strict = Tuning(map_grade_std_max_pct=0.05)
    (part,) = left_out_of(drive(seed=3, length_m=LENGTH_M), strict)
    assert (part.sensor, part.reason) == (None, UNSURE)
    assert part.length_m == pytest.approx(LENGTH_M, abs=40.0)


def test_a_record_of_one_subject_goes_on_beside_another() -> None:
    """Of two receivers one is cold: the good one's altitudes do not end the other's part."""
    spans = Spans()
    for second in range(20):
        spans.note("gps a", "cold", second, 10.0 * second, "gps")
        spans.note("gps b", None, second, 10.0 * second, "gps")
    assert list(spans.take()) == [Span("gps", "cold", 0, 19, 0.0, 190.0)]
    assert list(spans.take()) == []
