"""A real express bus through `wayline replay --feed`: the trip that it runs, told and found."""

import json
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import msgspec
import pytest

from unit.timetable.faulty_feeds import good_feed, write_folder
from wayline.messages import Arrivals, StopEvent
from wayline_eta.scores import score_of, sums_of
from wayline_evaluation.eta import predictions_of
from wayline_evaluation.replays import read_topic
from wayline_replay.replay import replay

WEST, EAST = "868590120", "868588920"
BEGUN_NS = 1_462_459_500_000_000_000
"""10:45:00."""
CAME_S = {"4632": 254, "14078": 1_070, "13056": 2_989, "13060": 3_434, "14253": 3_600}
"""After that, by the reports nearest to the stops (to some 15 s)."""


@pytest.fixture
def drive(recorded: Callable[[str], Path], tmp_path: Path) -> Callable[[str], Path]:
    """The drive with something added to its table of reports."""

    def make(columns: str, tables: str = "") -> Path:
        source, folder = recorded("wmata-5a-8062"), tmp_path / "drive"
        folder.mkdir()
        shutil.copy(source / "avl.csv", folder)
        text = (source / "drive.toml").read_text(encoding="utf-8")
        text = text.replace('heading_deg = "heading"', f'heading_deg = "heading"{columns}')
        (folder / "drive.toml").write_text(text + tables, encoding="utf-8")
        return folder

    return make


def told(folder: Path, feed: Path, out: Path) -> list[dict[str, Any]]:
    replay(folder, out, feed_paths=[feed])
    lines = (out / "progress.jsonl").read_text(encoding="utf-8").splitlines()
    return [json.loads(line) for line in lines]


@pytest.mark.parametrize(
    ("columns", "tables"),
    [
        (', assignment = "assignmentId"', ""),
        ("", '\n[assignment]\nblock_id = "SE-08"\n'),
    ],
    ids=["by the reports", "by the drive"],
)
def test_the_block_s_trip_is_told_from_the_first_report_on(
    drive: Callable[..., Path],
    recorded: Callable[[str], Path],
    tmp_path: Path,
    columns: str,
    tables: str,
) -> None:
    """And after its last stop the block's next one, layover included."""
    feed = recorded("wmata-5a-8062") / "gtfs"
    progress = told(drive(columns, tables), feed, tmp_path / "out")
    first_s = (progress[0]["t_ns"] - 1_462_459_509_000_000_000) * 1e-9
    assert first_s <= 1.0
    trips = list(dict.fromkeys((one["trip_id"], one["direction_id"]) for one in progress))
    assert trips == [(WEST, 1), (EAST, 0)]
    changes = next(one["t_ns"] for one in progress if one["trip_id"] == EAST)
    arrived_s = (changes - 1_462_459_500_000_000_000) * 1e-9  # of 10:45:00
    assert 3_600.0 - 60.0 < arrived_s < 3_600.0 + 60.0  # Dulles at 11:45:00


def test_the_trip_is_found_within_a_kilometre(
    drive: Callable[..., Path], recorded: Callable[[str], Path], tmp_path: Path
) -> None:
    """From place, direction and time alone, and kept through a detour and a spur."""
    progress = told(drive(""), recorded("wmata-5a-8062") / "gtfs", tmp_path / "out")
    driven = [one for one in progress if one["distance_m"] > 1_000.0 and one["trip_id"] != EAST]
    assert {one["trip_id"] for one in driven} == {WEST}
    assert [one for one in progress if one["trip_id"] == EAST]


def test_arrivals_are_told_by_a_timetable_that_nobody_has_driven(
    recorded: Callable[[str], Path], tmp_path: Path
) -> None:
    """An express bus that has a time every ten kilometres and is minutes off most of them."""
    folder = recorded("wmata-5a-8062")
    replay(folder, tmp_path, feed_paths=[folder / "gtfs"])
    told = [
        msgspec.structs.replace(each, stops=tuple(s for s in each.stops if s.stop_id in CAME_S))
        for each in read_topic(tmp_path, Arrivals)
    ]
    came = [
        StopEvent(
            t_ns=BEGUN_NS + after_s * 1_000_000_000,
            route_id="5A",
            trip_id=WEST,
            stop_id=stop_id,
            stop_sequence=number,
            kind="arrived",
            distance_m=0.0,
        )
        for number, (stop_id, after_s) in enumerate(CAME_S.items(), 1)
    ]
    score = score_of(sums_of(predictions_of(told, came)))
    spans = score.spans[:4]
    assert score.benchmark_share is not None
    assert score.benchmark_share >= 0.72
    most_s = (45.0, 65.0, 45.0, 95.0), (45.0, 45.0, 45.0, 80.0)
    for span, absolutely_s, on_average_s in zip(spans, *most_s, strict=True):
        assert span.mean_absolute_s is not None
        assert span.mean_absolute_s < absolutely_s
        assert span.mean_s is not None
        assert abs(span.mean_s) < on_average_s
        assert span.held_share is not None
        assert span.held_share >= 0.65


def test_a_feed_of_another_continent_is_said_to_fit_nothing(
    drive: Callable[..., Path], tmp_path: Path
) -> None:
    feed = write_folder(good_feed(), tmp_path / "feed")
    summary = replay(drive(""), tmp_path / "out", feed_paths=[feed])
    assert summary.counts.get("progress", 0) == 0
    assert any("no trip fits this drive" in warning for warning in summary.warnings)
