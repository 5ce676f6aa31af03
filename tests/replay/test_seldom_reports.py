"""Vehicles that report every half minute, through `wayline replay`: where and when they are."""

import csv
import datetime as dt
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any
from zoneinfo import ZoneInfo

import numpy as np
import pytest

from wayline_replay.replay import replay
from wayline_simulator.network.files import simulate_network
from wayline_simulator.network.model import NetworkModel

SECOND_NS = 1_000_000_000
ZONE = ZoneInfo("America/New_York")
PASSED = {
    "17201": "10:45:09",
    "4632": "10:49:14",
    "14078": "11:02:50",
    "13056": "11:34:49",
    "13060": "11:42:14",
    "14253": "11:45:00",
}
WEST = "868590120"


def told(out: Path, topic: str) -> list[dict[str, Any]]:
    with (out / f"{topic}.jsonl").open(encoding="utf-8") as file:
        return [json.loads(line) for line in file]


def clock(t_ns: int) -> str:
    return f"{dt.datetime.fromtimestamp(t_ns / SECOND_NS, ZONE):%H:%M:%S}"


@pytest.fixture
def express(recorded: Callable[[str], Path], tmp_path: Path) -> Path:
    """What is told of a real express bus."""
    folder = recorded("wmata-5a-8062")
    replay(folder, tmp_path, feed_paths=[folder / "gtfs"])
    return tmp_path


def test_arrivals_are_told_in_nearly_every_second_on_the_route_and_in_none_off_it(
    express: Path,
) -> None:
    on_route = {one["t_ns"]: one["on_route"] for one in told(express, "progress")}
    arrivals = {one["t_ns"]: bool(one["stops"]) for one in told(express, "arrivals")}
    seconds = [t_ns for t_ns, on in on_route.items() if on]
    assert sum(arrivals.get(t_ns, False) for t_ns in seconds) >= 0.95 * len(seconds)
    assert not any(arrivals.get(t_ns, False) for t_ns, on in on_route.items() if not on)
    assert not any(one["stale"] for one in told(express, "arrivals"))


def test_the_detour_is_off_the_route_and_little_else(express: Path) -> None:
    """10:51:52 to 10:52:56; two reports after it the bus is back."""
    progress = told(express, "progress")
    off = [clock(one["t_ns"]) for one in progress if not one["on_route"]]
    assert {"10:52:23", "10:52:56"} <= set(off)
    assert len(off) < 0.04 * len(progress)
    assert "10:54:05" not in off


def test_each_stop_is_come_to_once_when_the_bus_was_there(express: Path) -> None:
    came = [
        (one["stop_id"], clock(one["t_ns"]))
        for one in told(express, "stop_event")
        if one["trip_id"] == WEST and one["kind"] in {"arrived", "passed"}
    ]
    assert [stop_id for stop_id, _ in came] == list(PASSED)
    for stop_id, at in came:
        apart = dt.datetime.strptime(at, "%H:%M:%S") - dt.datetime.strptime(
            PASSED[stop_id], "%H:%M:%S"
        )
        assert abs(apart.total_seconds()) <= 30.0, stop_id


@pytest.fixture(scope="module")
def town(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """A simulated bus in a town, with its truth, and what is told of it."""
    folder, out = tmp_path_factory.mktemp("town"), tmp_path_factory.mktemp("told")
    simulate_network(NetworkModel(vehicles=1, hours=1.5, every_s=30.0), folder)
    drive = folder / "bus-1-day-1"
    replay(drive, out, feed_paths=[folder / "feed"])
    return drive, out


def test_a_bus_is_followed_between_its_reports(town: tuple[Path, Path]) -> None:
    """Stands at stops and lights, at speeds that no timetable has; it was 180 m off."""
    drive, out = town
    with (drive / "truth.csv").open(newline="") as file:
        truth = {int(float(row["t_s"])): row for row in csv.DictReader(file)}
    errors_m = []
    for one in told(out, "progress"):
        row = truth.get(one["t_ns"] // SECOND_NS)
        if row is not None and row["trip_id"] and row["trip_id"] == one["trip_id"]:
            errors_m.append(abs(one["distance_m"] - float(row["distance_m"])))
    assert len(errors_m) > 3_000
    assert np.median(errors_m) < 25.0
    assert np.quantile(errors_m, 0.95) < 130.0
    assert not any(one["stale"] for one in told(out, "arrivals"))


def test_stops_are_come_to_and_left_when_the_bus_did(town: tuple[Path, Path]) -> None:
    """None is told that the bus never comes to."""
    drive, out = town
    with (drive / "visits.csv").open(newline="") as file:
        visits = {(row["trip_id"], row["stop_id"]): row for row in csv.DictReader(file)}
    came = [one for one in told(out, "stop_event") if one["kind"] in {"arrived", "passed"}]
    apart_s = [
        abs(one["t_ns"] / SECOND_NS - float(visits[one["trip_id"], one["stop_id"]]["arrival_s"]))
        for one in came
    ]
    assert len({(one["trip_id"], one["stop_id"]) for one in came}) == len(came)
    assert len(came) >= 0.9 * len(visits)
    assert np.median(apart_s) < 8.0
    assert np.quantile(apart_s, 0.9) < 30.0
    promised = {
        (stop["trip_id"] or one["trip_id"], stop["stop_id"])
        for one in told(out, "arrivals")
        for stop in one["stops"]
        if one["trip_id"]
    }
    assert len(promised - visits.keys()) <= 0.01 * len(promised)
