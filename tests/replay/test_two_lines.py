"""A recorded way of line B, whose first 2 km are line A's too, by routes of both."""

import json
import shutil
from pathlib import Path
from typing import Any

import pytest

from wayline_replay.replay import replay

CASE = Path(__file__).parents[1] / "cases" / "two-lines-share-a-street"
TRUNK_M = 2_000.0


def topic(folder: Path, name: str) -> list[dict[str, Any]]:
    text = (folder / "out" / f"{name}.jsonl").read_text()
    return [json.loads(line) for line in text.splitlines()]


def arrivals(folder: Path, **options: Any) -> list[dict[str, Any]]:
    replay(folder, folder / "out", **options)
    return topic(folder, "arrivals")


def stops(told: list[dict[str, Any]]) -> set[str]:
    return {stop["stop_id"] for each in told for stop in each["stops"]}


@pytest.fixture
def drive(tmp_path: Path) -> Path:
    folder = tmp_path / "drive"
    shutil.copytree(CASE, folder)
    return folder


def with_tables(folder: Path, text: str) -> None:
    path = folder / "drive.toml"
    path.write_text(path.read_text() + text)


def test_nothing_is_told_beyond_the_fork_while_the_line_is_unknown(drive: Path) -> None:
    """Where nothing says what the vehicle runs: A's stop never, B's once A's line is left."""
    told = arrivals(drive, route_paths=[drive / "A.geojson", drive / "B.geojson"])
    known = next(at for at, each in enumerate(told) if stops([each]) - {"T1"})
    assert stops(told[:known]) == {"T1"}
    assert stops(told[known:]) == {"B1"}
    known_ns = told[known]["t_ns"]
    driven = topic(drive, "progress")
    known_m = next(each["distance_m"] for each in driven if each["t_ns"] >= known_ns)
    assert TRUNK_M < known_m < TRUNK_M + 500.0


def test_the_line_that_is_assigned_is_told_from_the_start(drive: Path) -> None:
    with_tables(drive, '\n[assignment]\nroute_id = "B"\n')
    told = arrivals(drive, route_paths=[drive / "A.geojson", drive / "B.geojson"])
    assert {each["route_id"] for each in told} == {"B"}
    assert stops(told[:1]) == {"T1", "B1"}
    assert stops(told) == {"T1", "B1"}


def test_a_drive_may_name_several_routes(drive: Path) -> None:
    """As `--route` given twice."""
    with_tables(drive, '\n[route]\npath = ["A.geojson", "B.geojson"]\n')
    assert stops(arrivals(drive)) == {"T1", "B1"}
