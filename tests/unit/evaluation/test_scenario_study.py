from pathlib import Path

import pytest

from unit.evaluation.drives import eastwards, off
from wayline_evaluation.outages import OutageScore
from wayline_evaluation.pose_errors import compared
from wayline_evaluation.scenario_plan import (
    PLANS,
    ScenarioPlan,
    StudyDrive,
    first_seed,
    outages_within,
    study_drives,
)
from wayline_evaluation.scenario_study import BARS
from wayline_evaluation.scenario_table import HEADER, markdown, yardstick_lines
from wayline_evaluation.studied import Studied
from wayline_evaluation.study import main
from wayline_replay.outages import Outage
from wayline_simulator.scenario_file import shipped_scenarios


def score(name: str, horizontal_m: float) -> OutageScore:
    return OutageScore(
        drive="town-101",
        filter=name,
        pass_number=1,
        start_s=240.0,
        duration_s=60.0,
        distance_m=1000.0,
        cross_track_m=0.0,
        along_track_m=horizontal_m,
        horizontal_m=horizontal_m,
        heading_deg=0.0,
        horizontal_pct=horizontal_m / 10.0,
        cross_track_pct=0.0,
    )


def studied(seed: int, pull_m: float) -> Studied:
    """A drive whose fusion is 3 m off where 1 m is possible."""
    truth = eastwards()
    errors = {
        "fusion": compared(off(truth, right_m=3.0), truth),
        "yardstick": compared(off(truth, right_m=1.0), truth),
    }
    scores = (score("fusion", 30.0), score("yardstick", 20.0))
    drive = StudyDrive("town", seed, ScenarioPlan())
    return Studied(drive, 1000.0, errors, scores, errors, {"pull, m": pull_m})


def test_a_row_has_figures_and_multiples_of_the_yardstick() -> None:
    """3 m are 3 times 1 m; the bar is that of the worst drive."""
    lines = list(markdown([studied(101, 20.0), studied(102, -40.0)]))
    row = dict(zip(HEADER, lines[2].strip("| ").split(" | "), strict=True))
    assert row["scenario"] == "town"
    assert row["drives, km"] == "2, 2"
    assert row["horizontal p50/p95, m"] == "3/3 (x3.0/3.0)"
    assert row["outages p68/p95, % of distance"] == "3/3 (x1.5/1.5), mean x1.5 of 2"
    assert row["position, heading in outages"] == "0/0, 100/100"
    assert row["its own bar"] == "pull, m -40"
    assert lines[3].startswith("| all with a yardstick | 2, 2 |")


def test_the_yardstick_is_told_to_be_honest_or_not() -> None:
    """1 m off with stds of 1 m: an NEES of 1."""
    with_gps, in_outages = yardstick_lines([studied(101, 0.0)])
    assert "with GPS, 1 drives: NEES 1.00" in with_gps
    assert "in outages, 1 drives: NEES 1.00" in in_outages


def test_outages_end_within_the_drive_and_leave_time_between() -> None:
    """60, 100, 150 s; the fourth of 200 s would last beyond the end."""
    outages = outages_within(1000.0)
    assert outages == [Outage(240.0, 60.0), Outage(420.0, 100.0), Outage(640.0, 150.0)]


def test_every_scenario_is_studied_and_every_bar_has_its_scenario() -> None:
    """A new scenario needs no change here, a renamed one does; no two drives share a device."""
    names = list(shipped_scenarios())
    assert {drive.scenario for drive in study_drives(names, 1)} == set(names)
    assert set(BARS) <= set(names)
    drives = study_drives(names, 2)
    assert len({drive.seed for drive in drives}) == len(drives)


def test_bad_input_is_one_line(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    """Status 2 and what to give instead."""
    with pytest.raises(SystemExit, match="2"):
        main([str(tmp_path), "--only", "nowhere"])
    assert "nowhere is not known" in capsys.readouterr().err


def test_a_study_simulates_replays_and_scores(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """From end to end on a short road: a row beside the yardstick, and files beside the drives."""
    monkeypatch.setitem(PLANS, "town", ScenarioPlan(length_m=1500.0))
    main([str(tmp_path), "--quick", "--only", "town"])
    printed = capsys.readouterr().out
    assert "| town | 1, 2 |" in printed
    assert "(x" in printed
    assert "yardstick with GPS" in printed
    assert (tmp_path / "study.md").read_text(encoding="utf-8") == printed
    assert f"town-{first_seed('town')}" in (tmp_path / "study.json").read_text(encoding="utf-8")
