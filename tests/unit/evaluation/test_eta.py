"""Arrivals scored against when the vehicle came."""

import msgspec
import pytest

from unit.eta.route_drives import SECOND_NS, START_NS
from wayline.messages import Arrivals, StopArrival, StopEvent, StopEventKind
from wayline_eta.scores import Prediction
from wayline_evaluation.eta import EtaRun, pooled, predictions_of, scored


def came(seconds: float, stop_id: str, kind: StopEventKind = "passed") -> StopEvent:
    t_ns = START_NS + round(seconds * SECOND_NS)
    return StopEvent(
        t_ns=t_ns, route_id="r", stop_id=stop_id, stop_sequence=1, kind=kind, distance_m=0.0
    )


def told(at_s: float, arrivals_s: dict[str, float], *, stale: bool = False) -> Arrivals:
    def instant(seconds: float) -> int:
        return START_NS + round(seconds * SECOND_NS)

    stops = tuple(
        StopArrival(
            stop_id=stop_id,
            name=stop_id,
            distance_m=0.0,
            arrival_ns=instant(seconds),
            early_ns=instant(seconds - 20.0),
            late_ns=instant(seconds + 40.0),
        )
        for stop_id, seconds in arrivals_s.items()
    )
    return Arrivals(t_ns=instant(at_s), route_id="r", stale=stale, stops=stops)


def actual_s(arrivals: Arrivals, *events: StopEvent) -> list[float | None]:
    return [each.actual_s for each in predictions_of([arrivals], events)]


def test_a_prediction_is_of_the_next_arrival_at_its_stop() -> None:
    events = [came(100.0, "a"), came(700.0, "a"), came(300.0, "b", "departed")]
    assert actual_s(told(0.0, {"a": 90.0}), *events) == [100.0]
    assert actual_s(told(110.0, {"a": 690.0}), *events) == [590.0]


def test_where_no_trip_was_certain_whichever_comes_next_counts() -> None:
    event = msgspec.structs.replace(came(100.0, "a"), trip_id="t")
    assert actual_s(told(0.0, {"a": 90.0}), event) == [100.0]


def test_who_is_seen_to_have_come_already_is_told_of_the_next_time() -> None:
    events = [came(100.0, "a"), came(700.0, "a")]
    assert actual_s(told(98.0, {"a": 690.0}), *events) == [602.0]


def test_what_never_came_is_a_ghost_but_not_what_the_drive_s_end_cut_off() -> None:
    events = [came(100.0, "a"), came(2_000.0, "z")]
    assert actual_s(told(0.0, {"b": 300.0}), *events) == [None]
    assert actual_s(told(0.0, {"b": 1_900.0}), *events) == []
    assert actual_s(told(0.0, {"a": 90.0}, stale=True), *events) == []


def test_figures_are_by_minutes_ahead() -> None:
    rows = [
        Prediction(100.0, 80.0, 140.0, 130.0),
        Prediction(100.0, 80.0, 140.0, 150.0),
        Prediction(400.0, 380.0, 440.0, 280.0),
        Prediction(100.0, 80.0, 140.0, None),
    ]
    score = scored(EtaRun("d", rows, 3, 9, 10))
    near, far = score.spans[0], score.spans[1]
    assert (near.count, near.mean_s, near.std_s, near.held_share) == (2, 40.0, 10.0, 0.5)
    assert near.benchmark_share == 1.0, "up to a minute and a half late"
    assert (far.mean_s, far.benchmark_share, far.held_share) == (-120.0, 0.0, 0.0)
    assert score.benchmark_share == 0.5
    assert score.ghost_share == 0.25
    assert score.told_share == 0.9
    assert score.spans[4].mean_s is None
    assert pooled([EtaRun("d", rows, 3, 9, 10)] * 2).spans[0].count == 4


def test_cal_itp_s_bounds_grow_with_the_minutes_ahead() -> None:
    def share(predicted_s: float, actual_s: float) -> float | None:
        row = Prediction(predicted_s, 0.0, 1_000.0, actual_s)
        spans = scored(EtaRun("d", [row], 1, 1, 1)).spans
        return next(each.cal_itp_share for each in spans if each.count)

    # ten minutes ahead: 146 s late, 145 s early
    assert share(600.0, 740.0) == 1.0
    assert share(600.0, 755.0) == 0.0
    assert share(600.0, 460.0) == 1.0
    assert share(60.0, 130.0) == pytest.approx(0.0)
