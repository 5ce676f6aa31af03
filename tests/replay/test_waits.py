"""Vehicles that stand, through `wayline replay`: at a circular line's terminus, between stops."""

import json
from pathlib import Path
from typing import Any

from wayline.route_file import write_route
from wayline_cli.gtfs_route import route_from_gtfs
from wayline_replay.replay import replay

CASES = Path(__file__).parents[1] / "cases"
SECOND_NS = 1_000_000_000


def arrivals(out: Path) -> list[dict[str, Any]]:
    lines = (out / "arrivals.jsonl").read_text(encoding="utf-8").splitlines()
    return [json.loads(line) for line in lines]


def test_a_shuttle_at_its_terminus_is_told_at_every_stop(tmp_path: Path) -> None:
    """It stands 300 s, drives a lap, stands again; nothing was told, and B not between D and B."""
    folder = CASES / "shuttle-parked-at-terminus"
    route = tmp_path / "route.geojson"
    write_route(route_from_gtfs(folder / "gtfs", "T"), route)
    replay(folder, tmp_path / "out", route_paths=[route])
    told = arrivals(tmp_path / "out")
    seconds = [one for one in told if one["t_ns"] >= told[0]["t_ns"] + 10 * SECOND_NS]
    assert len(seconds) >= 1_240
    assert all(
        {stop["stop_id"] for stop in one["stops"]} == {"A", "B", "C", "D"} for one in seconds
    )


def test_a_bus_that_stands_between_stops_is_told_to_come_later_and_later(tmp_path: Path) -> None:
    """For ten minutes it was 84 s to the next stop."""
    replay(CASES / "standing-between-stops", tmp_path)
    told = arrivals(tmp_path)
    begins_ns = told[0]["t_ns"] + 280 * SECOND_NS
    to_go_s, beyond_s = {}, {}
    for one in told:
        [stop] = [each for each in one["stops"] if each["stop_id"] == "S3"] or [None]
        if stop is not None:
            stood_s = (one["t_ns"] - begins_ns) // SECOND_NS
            to_go_s[stood_s] = (stop["arrival_ns"] - one["t_ns"]) / SECOND_NS
            beyond_s[stood_s] = (stop["late_ns"] - stop["arrival_ns"]) / SECOND_NS
    assert to_go_s[60] < to_go_s[300] < to_go_s[590]
    assert beyond_s[300] >= 180.0
    assert to_go_s[620] < 90.0
    assert beyond_s[620] < 30.0
