"""Errors of the destination's arrival at the stops before it, as papers/000 lists them."""

import csv
from collections.abc import Callable
from pathlib import Path

import pytest

from unit.eta.route_drives import SECOND_NS, START_NS
from wayline.errors import InputError
from wayline.messages import Arrivals, StopArrival, StopEvent, StopEventKind
from wayline_evaluation.eta import EtaRun, lap_score, report_of
from wayline_evaluation.eta_trials import (
    TrialErrors,
    by_stop,
    errors_of,
    statistics,
    trials_from,
    trials_of,
)


def instant(seconds: float) -> int:
    return START_NS + round(seconds * SECOND_NS)


def came(
    seconds: float, stop: int, *, trip_id: str | None = None, kind: StopEventKind = "passed"
) -> StopEvent:
    return StopEvent(
        t_ns=instant(seconds),
        route_id="r",
        trip_id=trip_id,
        stop_id=f"s{stop}",
        stop_sequence=stop,
        kind=kind,
        distance_m=0.0,
    )


def told(at_s: float, stop: int, arrival_s: float, trip_id: str | None = None) -> Arrivals:
    at = instant(arrival_s)
    arrival = StopArrival(
        stop_id=f"s{stop}", name="", distance_m=0.0, arrival_ns=at, early_ns=at, late_ns=at
    )
    return Arrivals(
        t_ns=instant(at_s), route_id="r", trip_id=trip_id, stale=False, stops=(arrival,)
    )


def test_a_lap_goes_from_the_first_stop_to_it_again() -> None:
    events = [came(5, 2), came(50, 1), came(100, 2), came(200, 1), came(260, 2), came(330, 1)]
    first, second = trials_of("d", events)
    assert (first.name, second.name) == ("d 1", "d 2")
    assert [visit.stop_id for visit in first.before] == ["s1", "s2"]
    said = [told(50, 1, 190), told(100, 1, 215), told(200, 1, 340), told(260, 1, 330)]
    errors = errors_of(first, said)
    assert errors is not None
    assert errors.errors_s == pytest.approx((10.0, -15.0))
    assert errors.mean_s == pytest.approx(-2.5)
    assert errors.std_s == pytest.approx(17.68, abs=0.01)


def test_laps_before_the_one_that_is_asked_for_are_left_out() -> None:
    trials = trials_of("d", [came(at_s, 1) for at_s in (0, 100, 200, 300)])
    assert [trial.name for trial in trials_from(2, trials, "d")] == ["d 2", "d 3"]
    assert trials_from(1, [], "d") == []
    with pytest.raises(InputError, match="d has 3 laps or trips"):
        trials_from(4, trials, "d")


def test_a_stop_that_eta_has_not_seen_reached_is_not_the_destination_yet() -> None:
    (trial,) = trials_of("d", [came(50, 1), came(100, 2), came(200, 1)])
    errors = errors_of(trial, [told(50, 1, 51), told(53, 1, 180)])
    assert errors is not None
    assert errors.stops == ("s1",)
    assert errors.errors_s == pytest.approx((20.0,))


def test_a_trip_goes_to_its_last_stop_and_its_next_day_is_another() -> None:
    day_s = 24 * 3_600.0
    events = [
        came(0, 1, trip_id="t", kind="departed"),
        came(60, 2, trip_id="t"),
        came(120, 3, trip_id="t", kind="arrived"),
        came(day_s, 2, trip_id="t"),
        came(day_s + 50, 3, trip_id="t"),
    ]
    trials = trials_of("d", events)
    assert [len(trial.before) for trial in trials] == [2, 1]
    assert errors_of(trials[0], [told(61, 3, 110, "t")]) is not None
    assert errors_of(trials[0], [told(61, 3, 110, "u")]) is None, "of another trip"


def test_a_route_that_is_no_loop_goes_to_its_last_stop() -> None:
    (trial,) = trials_of("d", [came(0, 1), came(60, 2), came(120, 3)])
    assert (len(trial.before), trial.end.stop_id) == (2, "s3")


def test_stops_are_pooled_over_trials_and_laps_follow_each_other() -> None:
    events = [came(50, 1), came(100, 2), came(200, 1), came(260, 2), came(330, 1)]
    said = [told(50, 1, 190), told(100, 1, 215), told(200, 1, 320), told(260, 1, 330)]
    trials = trials_of("d", events)
    errors = [found for trial in trials if (found := errors_of(trial, said))]
    laps = [lap_score(trial, said, events) for trial in trials]
    report = report_of([EtaRun("d", [], 5, 0, 0, errors, laps)])
    assert [(stop.stop_id, stop.count) for stop in report.stops] == [("s1", 2), ("s2", 2)]
    assert [stop.mean_s for stop in report.stops] == pytest.approx([10.0, -7.5])
    assert [lap.mean_absolute_s for lap in report.laps] == pytest.approx([12.5, 5.0])


def test_the_printed_tables_3_and_4_follow_from_table_2(recorded: Callable[[str], Path]) -> None:
    papers = recorded("papers")
    table_2 = rows(papers / "avl-table-2-timing-errors.csv")
    positions = [row["position"] for row in table_2]
    columns = [[float(row[f"trial_{number}_error_s"]) for row in table_2] for number in range(1, 8)]
    trials = [trial(number, positions, errors_s) for number, errors_s in enumerate(columns, 1)]
    for stop, row in zip(
        by_stop(trials), rows(papers / "avl-table-3-position-stats.csv"), strict=True
    ):
        assert stop.mean_s == pytest.approx(float(row["mean_printed_s"]), abs=0.005)
        assert stop.std_s == pytest.approx(float(row["std_printed_s"]), abs=0.005)
    for one, row in zip(trials, rows(papers / "avl-table-4-trial-stats.csv"), strict=True):
        assert one.mean_s == pytest.approx(float(row["mean_printed_s"]), abs=0.005)
        if row["std_printed_agrees_with"] == "sample":
            assert one.std_s == pytest.approx(float(row["std_printed_s"]), abs=0.005)


def trial(number: int, stops: list[str], errors_s: list[float]) -> TrialErrors:
    mean_s, std_s = statistics(errors_s)
    return TrialErrors(
        trial=str(number),
        route_id="r",
        stops=tuple(stops),
        errors_s=tuple(errors_s),
        mean_s=mean_s,
        std_s=std_s,
    )


def rows(path: Path) -> list[dict[str, str]]:
    with path.open(encoding="ascii", newline="") as file:
        return list(csv.DictReader(file))
