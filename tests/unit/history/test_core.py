"""One vehicle's history: what is kept, what is told of, and when."""

import pytest

from builders import at, fix
from unit.history.driven import LAT_DEG, LON_DEG, kept_of, legs, pose
from wayline.inputs import Tick
from wayline.messages import FusionStatus, Message, Progress, StopEvent, Torque, Verdict
from wayline_history.chunk import chunk_of
from wayline_history.core import PIECE_NS, HistoryCore
from wayline_history.layouts import ENGINE, POSES, REFUSALS


def test_of_ten_poses_a_second_the_first_is_kept() -> None:
    kept = kept_of(pose(tenth / 10.0, tenth, 10.0) for tenth in range(100))
    assert [row[0] for row in kept.rows("fused")] == [at(second) // 1000 for second in range(10)]


def test_every_fix_with_a_place_is_kept_and_its_receiver() -> None:
    fixes = [fix(0.1 * number, LAT_DEG, LON_DEG) for number in range(20)]
    kept = kept_of([*fixes, fix(2.0, LAT_DEG, LON_DEG, h_std_m=1.5)])
    assert len(kept.rows("raw")) == 21
    assert kept.pieces[0].rows["raw"].texts == ("test",)


def test_a_fix_without_a_place_is_not_kept() -> None:
    nowhere = fix(1.0, LAT_DEG, LON_DEG)
    blind = type(nowhere)(t_ns=at(2.0), valid=False)
    assert len(kept_of([nowhere, blind]).rows("raw")) == 1


def test_pieces_span_ten_seconds_and_the_last_holds_the_rest() -> None:
    kept = kept_of(legs((35, 10.0)))
    spans = [piece.span_ns() for piece in kept.pieces]
    assert len(spans) == 4
    assert all(span is not None and span[1] - span[0] <= PIECE_NS for span in spans)
    assert len(kept.rows("fused")) == 35
    assert kept.pieces[-1].is_last


def test_time_alone_hands_over_what_waits() -> None:
    """A vehicle that falls silent does not keep its last seconds to itself."""
    core = HistoryCore("bus-7")
    assert core.handle(pose(0.0, 0.0, 0.0), "fusion") == []
    (piece, *_) = core.handle(Tick(at(10.0)), "history")
    assert piece.rows["fused"].rows[0][0] == at(0.0) // 1000  # type: ignore[union-attr]


def test_a_change_of_mode_and_an_outage_are_told_of() -> None:
    drive = [
        pose(0.0, 0.0, 10.0),
        pose(3.0, 30.0, 10.0, mode="dead_reckoning"),
        pose(9.0, 90.0, 10.0, mode="fused"),
    ]
    kept = kept_of(drive)
    assert [event.name for event in kept.events("mode")] == ["fused", "dead_reckoning", "fused"]
    (outage,) = kept.events("outage")
    assert (outage.t_ns, outage.until_ns) == (at(3), at(9))


def test_an_outage_that_goes_on_is_told_of_open() -> None:
    kept = kept_of([pose(0.0, 0.0, 10.0), pose(5.0, 50.0, 10.0, mode="lost")])
    (outage,) = kept.events("outage")
    assert outage.until_ns is None


def refusal(seconds: float, reason: str) -> FusionStatus:
    verdict = Verdict(
        sensor="gps_position",
        t_ns=at(seconds),
        accepted=False,
        nis=99.0,
        threshold=9.0,
        reason=reason,
    )
    return FusionStatus(t_ns=at(seconds), verdicts=(verdict,))


def test_refusals_are_told_of_by_reason_and_counted() -> None:
    told = [refusal(second, "far") for second in (1, 2, 3)]
    told += [refusal(4, "late"), refusal(200, "far")]
    events = kept_of(told).events("rejected")
    assert [(event.name, event.count) for event in events] == [
        ("gps_position: far", 3),
        ("gps_position: late", 1),
        ("gps_position: far", 1),
    ]
    assert (events[0].t_ns, events[0].until_ns) == (at(1), at(3))


def test_each_refusal_is_kept_and_counted_in_its_trip() -> None:
    drive: list[Message] = list(legs((60, 0.0), (100, 10.0), (400, 0.0)))
    told = [refusal(5, "far"), *(refusal(70 + second, "far") for second in range(5))]
    kept = kept_of([*drive[:80], *told, *drive[80:]])
    assert len(kept.rows("refused")) == 6
    assert kept.trips[0].rejected == 5


def test_two_sensors_refused_at_one_instant_are_two_rows() -> None:
    texts: dict[str, int] = {}
    rows = [REFUSALS.row(verdict_of(sensor), texts) for sensor in ("gps_position", "course")]
    assert len(chunk_of(REFUSALS, [*rows, rows[0]], texts)) == 2


def verdict_of(sensor: str) -> Verdict:
    return Verdict(sensor=sensor, t_ns=at(1), accepted=False, nis=9.0, threshold=1.0, reason="far")


def progress(seconds: float, *, on_route: bool) -> Progress:
    return Progress(
        t_ns=at(seconds),
        route_id="5A",
        distance_m=10.0 * seconds,
        lat_deg=LAT_DEG,
        lon_deg=LON_DEG,
        cross_track_m=0.0,
        distance_std_m=1.0,
        on_route=on_route,
        speed_mps=10.0,
    )


def test_leaving_the_route_and_coming_back_is_one_event() -> None:
    on_route = [True, False, False, True]
    told = [progress(second, on_route=on) for second, on in enumerate(on_route)]
    kept = kept_of(told)
    (off_route,) = kept.events("off_route")
    assert (off_route.t_ns, off_route.until_ns, off_route.name) == (at(1), at(3), "5A")
    assert len(kept.rows("on_route")) == 4


def test_a_stop_event_is_kept() -> None:
    stop = StopEvent(
        t_ns=at(2), route_id="5A", stop_id="S1", stop_sequence=1, kind="arrived", distance_m=10.0
    )
    (event,) = kept_of([pose(1, 0, 0), stop]).events("stop")
    assert (event.name, event.t_ns, event.detail) == ("arrived S1", at(2), "route 5A")


def test_an_event_says_what_disrupted_the_vehicle() -> None:
    stop = StopEvent(
        t_ns=at(2),
        route_id="5A",
        stop_id="S1",
        stop_sequence=1,
        kind="skipped",
        distance_m=10.0,
        disruption="detour",
    )
    (event,) = kept_of([pose(1, 0, 0), stop]).events("stop")
    assert event.detail == "route 5A, detour"


@pytest.mark.parametrize(("rpm", "engine"), [(0.0, 0), (800.0, 1)])
def test_the_engine_stands_with_each_pose(rpm: float, engine: int) -> None:
    kept = kept_of([Torque(t_ns=at(0), engine_speed_rpm=rpm), pose(1, 0, 0)])
    assert kept.rows("fused")[0][POSES.place(ENGINE)] == engine
