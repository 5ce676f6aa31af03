"""How well a vehicle is followed and its arrivals are told, on numbers made by hand."""

from pathlib import Path

import numpy as np
import pytest

from wayline.errors import InputError
from wayline.messages import Arrivals, Progress, StopArrival, StopEvent
from wayline_evaluation.arrival_study import read_visits
from wayline_evaluation.arrivals import AlongTruth, ArrivalRun, arrival_run, pooled, score

START_S = 1_700_000_000
NS = 1_000_000_000


def progress(second: int, distance_m: float, trip_id: str | None = "T") -> Progress:
    return Progress(
        t_ns=(START_S + second) * NS,
        route_id="R",
        trip_id=trip_id,
        distance_m=distance_m,
        lat_deg=48.0,
        lon_deg=11.0,
        cross_track_m=0.0,
        distance_std_m=5.0,
        on_route=True,
        speed_mps=8.0,
    )


def arrivals(second: int, told_s: dict[str, float], *, stale: bool = False) -> Arrivals:
    """Predicted instants by stop, within 30 s of them."""
    stops = tuple(
        StopArrival(
            stop_id=stop_id,
            name=stop_id,
            distance_m=1.0,
            arrival_ns=round((START_S + at_s) * NS),
            early_ns=round((START_S + at_s - 30) * NS),
            late_ns=round((START_S + at_s + 30) * NS),
        )
        for stop_id, at_s in told_s.items()
    )
    return Arrivals(
        t_ns=(START_S + second) * NS, route_id="R", trip_id="T", stale=stale, stops=stops
    )


def event(second: float, stop_id: str) -> StopEvent:
    return StopEvent(
        t_ns=round((START_S + second) * NS),
        route_id="R",
        trip_id="T",
        stop_id=stop_id,
        stop_sequence=1,
        kind="arrived",
        distance_m=0.0,
    )


def run() -> ArrivalRun:
    """Three seconds of a trip 10 m ahead; A comes at 100 s, B at 400 s, C never."""
    truth = AlongTruth(
        np.array([START_S + 0.0, START_S + 1.0, START_S + 2.0]),
        np.array(["T", "T", ""]),
        np.array([100.0, 108.0, np.nan]),
    )
    return arrival_run(
        "drive",
        truth,
        {("T", "A"): START_S + 100.0, ("T", "B"): START_S + 400.0},
        progress=[progress(0, 110.0), progress(1, 118.0), progress(2, 126.0)],
        arrivals=[
            arrivals(0, {"A": 90.0, "B": 500.0, "C": 600.0}),
            arrivals(1, {}, stale=True),
            arrivals(2, {"A": 200.0}),
        ],
        events=[event(103.0, "A"), event(180.0, "A")],
    )


def test_a_drive_is_scored_by_what_happened() -> None:
    scored = score(run())
    assert (scored.seconds, scored.along_p50_m) == (2, 10.0)
    assert scored.told_share == pytest.approx(2 / 3)
    assert scored.stale_share == pytest.approx(1 / 3)
    assert (scored.visits, scored.events, scored.event_p50_s) == (2, 1, 3.0)
    # A 10 s late is within -30 to 90, 100 s early is not; B 100 s early is not within -60
    assert scored.benchmark_shares == (0.5, None, 0.0, None)
    assert scored.within_share == pytest.approx(1 / 3)
    assert scored.ghost_share == pytest.approx(1 / 3)


def test_drives_are_pooled_by_their_seconds() -> None:
    both = pooled([run(), run()])
    assert (both.seconds, both.visits) == (4, 4)
    assert both.benchmark_shares == (0.5, None, 0.0, None)


def test_a_drive_without_visits_is_refused_with_the_mend(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="wayline simulate network"):
        read_visits(tmp_path)
    (tmp_path / "visits.csv").write_text("trip_id,stop_id\nT,A\n")
    with pytest.raises(InputError, match="no column arrival_s"):
        read_visits(tmp_path)
