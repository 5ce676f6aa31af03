"""What a receiver is told of its Dopplers on a simulated drive, from its files on."""

import json
from pathlib import Path
from typing import NamedTuple

import pytest
from typer.testing import CliRunner

from wayline.errors import InputError
from wayline_cli.__main__ import app
from wayline_evaluation.tracking.aiding_study import AidingPlan, aiding_study
from wayline_simulator.drive_folder import simulate
from wayline_simulator.raw_model import RawModel
from wayline_simulator.scenario import Scenario, overlaid

ROAD = {"road": {"kind": "main", "length_m": 4500.0}}


class Study(NamedTuple):
    """What a user sees, and what a program does."""

    shown: str
    drive: dict[str, dict[str, float]]


@pytest.fixture(scope="module")
def study(tmp_path_factory: pytest.TempPathFactory) -> Study:
    """Some minutes of main road, `mems` sensors, a minute of them without satellites."""
    folder = tmp_path_factory.mktemp("main-road")
    simulate(overlaid(Scenario(preset="mems", raw=RawModel()), ROAD), folder)
    path = folder / "aiding.json"
    options = ["--every", "150", "--start", "100", "--json", str(path)]
    answer = CliRunner().invoke(app, ["evaluate", "aiding", str(folder), *options])
    assert answer.exit_code == 0, answer.output
    (drive,) = json.loads(path.read_text())["drives"]
    return Study(answer.output, drive)


@pytest.mark.parametrize("part", ["with_gps", "in_outages"])
def test_told_dopplers_are_within_three_hz_and_an_order_better_than_without_velocity(
    study: Study, part: str
) -> None:
    found = study.drive[part]
    assert found["count"] > 200
    assert found["rms_hz"] < 3.0
    assert found["in_two_std"] > 0.9
    assert found["still_rms_hz"] > max(10.0 * found["rms_hz"], 20.0)


def test_the_table_says_what_it_is_of(study: Study) -> None:
    assert "outages of 60 s every 150 s" in study.shown


def test_a_drive_without_raw_measurements_is_refused_with_the_mend(tmp_path: Path) -> None:
    simulate(
        overlaid(Scenario(preset="mems"), {"road": {"kind": "main", "length_m": 3000.0}}), tmp_path
    )
    with pytest.raises(InputError, match=r"no raw measurements; add a \[\[raw\]\] table"):
        aiding_study([tmp_path], AidingPlan(), 1, lambda _, __: None)
