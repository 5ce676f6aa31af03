"""`wayline evaluate tracking`: from the command line to its tables."""

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner, Result

from wayline.errors import InputError
from wayline_cli.__main__ import app


def evaluated(*arguments: str) -> Result:
    return CliRunner().invoke(app, ["evaluate", "tracking", *arguments])


def report_of(folder: Path, *arguments: str) -> dict[str, Any]:
    path = folder / "report.json"
    answer = evaluated(*arguments, "--json", str(path))
    assert answer.exit_code == 0, answer.output
    found: dict[str, Any] = json.loads(path.read_text())
    return found


@pytest.fixture(scope="module")
def report(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """The study as it is told without options: a hundred runs of a minute."""
    return report_of(tmp_path_factory.mktemp("tracking"))


def loops(report: dict[str, Any], beginning: str) -> Sequence[dict[str, Any]]:
    found: Sequence[dict[str, Any]] = [
        loop for loop in report["loops"] if loop["name"].startswith(beginning)
    ]
    assert found
    return found


def test_the_papers_three_decibels_are_gained_in_tracking(report: dict[str, Any]) -> None:
    """From 1.2 Hz to what the aid's own error allows, by lock lost."""
    (unaided,) = loops(report, "told nothing")
    (aided,) = loops(report, "aided, as its error allows")
    assert unaided["bandwidth_hz"] == 1.2
    assert aided["bandwidth_hz"] < unaided["bandwidth_hz"]
    assert aided["gained_db"] == pytest.approx(3.0, abs=0.5)


def test_the_narrower_an_aided_loop_the_weaker_its_signal_may_be(report: dict[str, Any]) -> None:
    gained = [loop["gained_db"] for loop in report["loops"] if loop["name"] == "aided"]
    assert gained == sorted(gained)


@pytest.mark.parametrize("wrong", ["heading 5 deg off", "gyro spike"])
def test_a_wrong_aid_loses_no_more_than_none(report: dict[str, Any], wrong: str) -> None:
    """At every strength; two runs of a hundred are chance."""
    (unaided,) = loops(report, "told nothing")
    for aided in loops(report, wrong):
        for without, with_aid in zip(
            unaided["lost"]["shares"], aided["lost"]["shares"], strict=True
        ):
            assert with_aid <= without + 0.02


def test_an_aid_that_says_how_wrong_it_is_gets_a_wider_loop(report: dict[str, Any]) -> None:
    (unsaid,) = loops(report, "heading 5 deg off, unsaid")
    (said,) = loops(report, "heading 5 deg off, its std says so")
    assert unsaid["bandwidth_hz"] < said["bandwidth_hz"] <= 1.2


def test_a_narrower_search_finds_weaker_signals(report: dict[str, Any]) -> None:
    rows = report["acquisition"]
    assert all(row["gained_db"] > 0.3 for row in rows[:-1])
    assert rows[0]["gained_db"] > rows[1]["gained_db"]
    ranges_hz = [row["search"]["half_range_hz"] for row in rows]
    assert ranges_hz == sorted(ranges_hz, reverse=True)


def test_figures_8_and_9_show_less_noise_with_the_aid(report: dict[str, Any]) -> None:
    wide, _, narrow = report["figure_8"]["tracks"]
    assert (wide["bandwidth_hz"], narrow["bandwidth_hz"]) == (1.0, 0.1)
    assert wide["lost_share"] == 1.0
    assert wide["locked_s"] < 1.0
    assert narrow["lost_share"] < 0.5
    assert narrow["error_rms_hz"] < wide["error_rms_hz"]
    assert report["figure_9"]["power_db"] > 1.0


def test_every_assumption_is_named(report: dict[str, Any]) -> None:
    assert {"loop", "lock", "satellite", "clock", "aid", "bandwidth", "search"} <= set(
        report["assumptions"]
    )


def test_the_same_seed_gives_the_same_report(tmp_path: Path) -> None:
    few = ("--runs", "4", "--seconds", "5")
    assert report_of(tmp_path, *few) == report_of(tmp_path, *few)
    assert report_of(tmp_path, *few) != report_of(tmp_path, *few, "--seed", "2")


def test_tables_and_picture(tmp_path: Path) -> None:
    picture = tmp_path / "tracking.png"
    answer = evaluated("--runs", "4", "--seconds", "5", "--plot", str(picture))
    assert answer.exit_code == 0, answer.output
    assert "1.0557" in answer.output
    assert "half lost" in answer.output
    assert picture.read_bytes().startswith(b"\x89PNG")


def test_a_drive_that_is_none_is_refused_in_one_line(tmp_path: Path) -> None:
    answer = evaluated(str(tmp_path))
    assert isinstance(answer.exception, InputError)
    assert "\n" not in str(answer.exception)
