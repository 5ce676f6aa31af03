"""How good predictions were: remembered until the vehicle comes, scored, kept and told."""

import time
from argparse import Namespace
from pathlib import Path
from typing import Any

import msgspec
import pytest
import sqlalchemy as sa
from fastapi.testclient import TestClient
from prometheus_client import CollectorRegistry

from unit.eta.route_drives import SECOND_NS, SQUARE, START_NS, poses, route_of
from wayline.database import open_database
from wayline.http import Healthz
from wayline.http_settings import HttpSettings
from wayline.messages import Arrivals, Progress, StopArrival, StopEvent, StopEventKind
from wayline.patient_store import PatientStore, Tables
from wayline.settings import Settings
from wayline.spool import Waiting
from wayline.telemetry import Telemetry
from wayline.tuning import Tuning
from wayline_eta.__main__ import WAITING_MAX, build
from wayline_eta.accuracy import Accuracy, AccuracyParameters
from wayline_eta.accuracy_metrics import AccuracyCollector
from wayline_eta.app import create_eta_app
from wayline_eta.board import EtaBoard
from wayline_eta.core import eta_node
from wayline_eta.lessons import lessons_by
from wayline_eta.promises import PROMISES_MAX, Promises
from wayline_eta.records import SCORED_DAYS_MAX, Scored, ScoredDay
from wayline_eta.scores import Prediction, Sums, added, score_of, sums_of
from wayline_eta.store import EtaTables
from wayline_evaluation.replays import read_topic
from wayline_replay.replay import replay

DEMO = Path(__file__).parents[3] / "deploy" / "demo" / "avl-shuttle"

MINUTE_NS = 60 * SECOND_NS
DAY_NS = 24 * 60 * MINUTE_NS
BEGIN_NS = START_NS // MINUTE_NS * MINUTE_NS


def instant(seconds: float) -> int:
    return BEGIN_NS + round(seconds * SECOND_NS)


def came(seconds: float, stop_id: str = "a", kind: StopEventKind = "passed") -> StopEvent:
    return StopEvent(
        t_ns=instant(seconds),
        route_id="r",
        stop_id=stop_id,
        stop_sequence=1,
        kind=kind,
        distance_m=0.0,
    )


def told(at_s: float, arrivals_s: dict[str, float], *, stale: bool = False) -> Arrivals:
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


def on_route(at_s: float) -> Progress:
    return Progress(
        t_ns=instant(at_s),
        route_id="r",
        distance_m=0.0,
        lat_deg=0.0,
        lon_deg=0.0,
        cross_track_m=0.0,
        distance_std_m=1.0,
        on_route=True,
        speed_mps=1.0,
    )


def scored(promises: Promises, at_s: float) -> Sums:
    return added(each.sums for each in promises.take(instant(at_s)))


def test_each_minutes_prediction_is_scored_when_the_vehicle_comes() -> None:
    promises = Promises()
    for second in range(300):
        promises.note(on_route(second), told(second, {"a": 290.0, "b": 2_500.0}))
    promises.happened(came(300.0, kind="arrived"))
    promises.happened(came(320.0, kind="departed"))
    sums = scored(promises, 360.0)
    assert (sums.predictions, sums.arrivals, sums.ghosts) == (5, 1, 0), "one a minute, of a alone"
    assert [each.count for each in sums.spans] == [2, 3, 0, 0, 0], "1, 2 and 3, 4, 5 minutes ahead"
    assert sums.spans[0].error_s == pytest.approx(20.0)
    assert (sums.on_route_s, sums.told_s) == (300, 300)
    assert scored(promises, 420.0) == Sums(), "nothing is told twice"
    promises.happened(came(2_500.0, "b"))
    assert scored(promises, 2_520.0).predictions == 0, "more than half an hour ahead"


def test_a_trip_that_begins_where_nobody_saw_it_come_is_scored_by_its_departure() -> None:
    promises = Promises()
    promises.note(None, told(0.0, {"a": 100.0}))
    promises.happened(came(130.0, kind="departed"))
    sums = scored(promises, 180.0)
    assert (sums.predictions, sums.arrivals) == (1, 0)
    assert sums.spans[0].error_s == pytest.approx(30.0)


def test_what_is_told_of_the_next_lap_while_the_vehicle_stands_waits_for_it() -> None:
    promises = Promises()
    promises.happened(came(0.0, kind="arrived"))
    promises.note(None, told(60.0, {"a": 600.0}))
    promises.happened(came(70.0, kind="departed"))
    assert scored(promises, 120.0).predictions == 0
    promises.happened(came(660.0))
    assert scored(promises, 660.0).spans[3].error_s == pytest.approx(60.0)


def test_what_was_told_before_the_trip_was_certain_is_scored_too() -> None:
    promises = Promises()
    promises.note(None, told(0.0, {"a": 100.0}))
    promises.happened(msgspec.structs.replace(came(110.0), trip_id="t"))
    sums = scored(promises, 120.0)
    assert (sums.predictions, sums.ghosts) == (1, 0)


def test_what_is_left_out_or_long_overdue_is_a_ghost() -> None:
    promises = Promises()
    promises.note(None, told(0.0, {"a": 100.0, "b": 200.0}))
    promises.happened(came(90.0, "a", "skipped"))
    assert scored(promises, 120.0).ghosts == 1
    assert scored(promises, 1_980.0).ghosts == 0, "it may still come"
    assert scored(promises, 2_040.0).ghosts == 1


def test_old_positions_promise_nothing() -> None:
    promises = Promises()
    promises.note(on_route(0.0), told(0.0, {"a": 100.0}, stale=True))
    promises.happened(came(100.0))
    sums = scored(promises, 120.0)
    assert (sums.predictions, sums.on_route_s, sums.told_s) == (0, 1, 0)


def test_the_oldest_promises_are_forgotten_where_there_are_too_many() -> None:
    promises = Promises()
    stops = {f"s{stop}": 1_700.0 for stop in range(150)}
    for minute in range(20):
        promises.note(None, told(60.0 * minute, stops))
    for stop_id in stops:
        promises.happened(came(1_700.0, stop_id))
    assert scored(promises, 1_740.0).predictions <= PROMISES_MAX


def test_mbta_scores_by_the_minutes_that_were_told() -> None:
    rows = [
        Prediction(100.0, 0.0, 900.0, 165.0),  # 65 s late of under three minutes
        Prediction(100.0, 0.0, 900.0, 155.0),
        Prediction(420.0, 0.0, 900.0, 600.0),  # three minutes late of seven
        Prediction(800.0, 0.0, 900.0, 500.0),  # five early of thirteen
    ]
    score = score_of(sums_of(rows))
    assert [each.share for each in score.mbta] == [0.5, None, 1.0, 0.0]
    assert score.mbta_share == 0.5


def test_sums_of_parts_are_those_of_the_whole() -> None:
    rows = [Prediction(60.0 * m, 50.0 * m, 70.0 * m, 61.0 * m) for m in range(1, 25)]
    parts = added([sums_of(rows[:7]), sums_of(rows[7:]), sums_of([])])
    whole = sums_of(rows)
    assert (parts.predictions, parts.mbta) == (whole.predictions, whole.mbta)
    for part, other in zip(parts.spans, whole.spans, strict=True):
        assert msgspec.structs.astuple(part) == pytest.approx(msgspec.structs.astuple(other))


def a_minute(t_ns: int, route_id: str = "r", error_s: float = 10.0) -> Scored:
    sums = sums_of([Prediction(100.0, 90.0, 120.0, 100.0 + error_s)])
    return Scored(t_ns=t_ns, route_id=route_id, sums=sums)


def test_answers_are_of_the_newest_days_and_of_one_route_or_all() -> None:
    accuracy = Accuracy()
    for day, route_id, error_s in ((0, "r", 5.0), (3, "r", 10.0), (3, "q", 30.0)):
        accuracy.take(a_minute(START_NS + day * DAY_NS, route_id, error_s))
    newest = accuracy.answer(AccuracyParameters(days=1))
    assert newest.spans[0].mean_s == pytest.approx(20.0)
    assert newest.first_day == newest.last_day == "2023-11-17"
    of_r = accuracy.answer(AccuracyParameters(route_id="r", days=4))
    assert of_r.spans[0].mean_s == pytest.approx(7.5)
    assert of_r.first_day == "2023-11-14"
    assert accuracy.answer(AccuracyParameters(route_id="nobody")).predictions == 0
    assert accuracy.by_route(1)["q"].spans[0].mean_s == pytest.approx(30.0)


def test_days_long_ago_are_forgotten() -> None:
    accuracy = Accuracy()
    for day in range(SCORED_DAYS_MAX + 5):
        accuracy.take(a_minute(START_NS + day * DAY_NS))
    assert accuracy.by_route(10 * SCORED_DAYS_MAX)["r"].predictions == SCORED_DAYS_MAX


def test_scores_are_kept_and_a_minute_counts_once(database_url: str) -> None:
    engine = open_database(database_url, "wayline_eta")
    tables = EtaTables(engine)
    running = Accuracy()
    for vehicle_id, minute in (
        ("bus-1", a_minute(START_NS)),
        ("bus-1", a_minute(START_NS)),
        ("bus-1", a_minute(START_NS + MINUTE_NS)),
        ("bus-2", a_minute(START_NS)),
    ):
        running.take(minute)
        for known in tables.save(vehicle_id, minute):
            assert isinstance(known, ScoredDay)
            running.take(known)
    assert running.answer(AccuracyParameters()).predictions == 3
    accuracy = Accuracy()
    anew = lessons_by((), accuracy.take)
    for kept in [*EtaTables(engine).look(), *EtaTables(engine).look()]:
        anew.remember(kept)  # the second time as when the database was away
    engine.dispose()
    assert accuracy.answer(AccuracyParameters()).predictions == 3


def test_a_fleet_s_scores_of_one_minute_are_kept_by_one_write(database_url: str) -> None:
    """All have theirs on the minute; a write for each kept a disk busy for seconds."""
    engine = open_database(database_url, "wayline_eta")
    commits: list[object] = []
    sa.event.listen(engine, "commit", commits.append)
    fleet = [Waiting(f"bus-{at}", a_minute(START_NS, "qr"[at % 2])) for at in range(500)]
    known = EtaTables(engine).save_all([*fleet, *fleet[:10]])
    assert len(commits) == 1
    days = [each for each in known if isinstance(each, ScoredDay)]
    assert [(each.route_id, each.sums.predictions) for each in days] == [("q", 250), ("r", 250)]
    assert [each for each in EtaTables(engine).look() if isinstance(each, ScoredDay)] == days
    engine.dispose()


def test_of_a_fleet_s_scores_none_is_lost_and_the_whole_day_is_told(database_url: str) -> None:
    told: list[msgspec.Struct] = []
    tables = Tables(database_url, "wayline_eta", EtaTables)
    store = PatientStore(tables, Settings(), told.append, capacity=WAITING_MAX)
    for at in range(3_000):
        store.put(f"bus-{at}", a_minute(START_NS))
    store.start(lambda: None)
    deadline_s = time.monotonic() + 60.0
    while store.backlog:
        assert time.monotonic() < deadline_s
        time.sleep(0.1)
    store.close()
    store.hand_over()
    assert store.detail is None
    days = [each for each in told if isinstance(each, ScoredDay)]
    assert days[-1].sums.predictions == 3_000


def test_a_drive_s_predictions_are_scored_on_its_way() -> None:
    accuracy = Accuracy()
    lessons = lessons_by((), accuracy.take)
    route = route_of(SQUARE, route_id="north/south", stops_m=[300.0, 900.0, 1500.0])
    node = eta_node([route], Tuning(), lessons)
    for pose, _ in poses(SQUARE, [10.0] * 151):
        list(node.take(pose, "fusion"))
    list(node.finish(START_NS + 151 * SECOND_NS))
    answer = accuracy_of(accuracy, "?route_id=north/south&days=2")
    assert answer["arrivals"] == 3
    assert answer["predictions"] == 6, "at once of three stops, then of two, then of the last"
    assert answer["told_share"] == 1.0
    assert abs(answer["spans"][0]["mean_s"]) < 5.0


def accuracy_of(accuracy: Accuracy, question: str) -> dict[str, Any]:
    app = create_eta_app(EtaBoard(), [], HttpSettings(), accuracy=accuracy)
    answer = TestClient(app, base_url="http://localhost").get(f"/v1/accuracy{question}")
    assert answer.status_code == 200, answer.text
    found: dict[str, Any] = answer.json()
    return found


def test_unfit_questions_are_refused() -> None:
    app = create_eta_app(EtaBoard(), [], HttpSettings())
    answer = TestClient(app, base_url="http://localhost").get("/v1/accuracy?days=0")
    assert (answer.status_code, answer.json()["invalid"][0]["name"]) == (422, "days")


def test_prometheus_is_told_by_route_and_minutes_ahead() -> None:
    accuracy = Accuracy()
    accuracy.take(a_minute(START_NS, "north/south", 10.0))
    registry = CollectorRegistry()
    registry.register(AccuracyCollector(accuracy))
    labels = {"route_id": "north/south", "minutes": "0-3"}
    name = "wayline_eta_prediction_mean_seconds"
    assert registry.get_sample_value(name, labels) == pytest.approx(10.0)
    assert registry.get_sample_value(name, {**labels, "minutes": "3-6"}) is None


def test_a_service_that_starts_answers_with_what_a_replay_has_kept(tmp_path: Path) -> None:
    """Replayed twice, and told by another process on the same database."""
    url = f"sqlite:///{tmp_path / 'eta.db'}"
    for out in ("once", "again"):
        replay(DEMO, tmp_path / out, database_url=url)
    service = build(Settings(vehicles=("*",), database_url=url), Namespace())
    assert service.store is not None
    assert service.make_app is not None
    service.store.hand_over()
    telemetry = Telemetry("eta", 0)
    app = service.make_app(lambda: Healthz(ok=True, service="eta", version="0"), telemetry)
    http = TestClient(app, base_url="http://localhost")
    answer = http.get("/v1/accuracy?days=1").json()
    events = read_topic(tmp_path / "once", StopEvent)
    assert answer["arrivals"] == sum(event.kind in {"arrived", "passed"} for event in events) > 3
    assert answer["predictions"] > answer["arrivals"]
    assert "wayline_eta_prediction_arrivals" in http.get("/metrics").text
    service.store.close()
