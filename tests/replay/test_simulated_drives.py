"""Simulated drives as folders: the same bytes again, a truth that closes, a replay that fits."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from wayline.drive_file import load_drive
from wayline_evaluation.pose_errors import compared
from wayline_evaluation.reference import Reference
from wayline_evaluation.replays import needed_truth, read_replay
from wayline_evaluation.sensed_drive import sense
from wayline_evaluation.slope import average_std, profiles_of
from wayline_evaluation.slope_study import thesis_grades
from wayline_replay.replay import replay
from wayline_replay.stream import DriveStream
from wayline_simulator.drive_folder import simulate
from wayline_simulator.scenario import Scenario, overlaid
from wayline_simulator.scenario_file import load_scenario

Floats = NDArray[np.float64]

SMALL = overlaid(Scenario(preset="mems"), {"road": {"kind": "hills", "length_m": 4000.0}})
PAPER_PCT = {
    "thesis-motorway": {"gps": 0.23, "torque": 0.19, "barometer": 0.29},
    "thesis-main-road": {"gps": 0.24, "torque": 0.19, "barometer": 0.26},
}
"""Tables 5.1 and 5.2 of papers/004."""


@pytest.fixture(scope="module")
def small(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("small")
    simulate(SMALL, folder)
    return folder


def bytes_of(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in sorted(folder.iterdir())}


def truth_of(folder: Path) -> dict[str, Floats]:
    rows = np.genfromtxt(folder / "truth.csv", delimiter=",", names=True)
    return {name: rows[name] for name in rows.dtype.names or ()}


def test_the_same_seed_gives_the_same_bytes(small: Path, tmp_path: Path) -> None:
    """Every file, to the last byte."""
    simulate(SMALL, tmp_path)
    assert bytes_of(tmp_path) == bytes_of(small)


def test_another_seed_gives_another_drive(small: Path, tmp_path: Path) -> None:
    """Road and noise alike."""
    simulate(overlaid(SMALL, {"seed": 2}), tmp_path)
    again, before = bytes_of(tmp_path), bytes_of(small)
    assert all(again[name] != before[name] for name in ("truth.csv", "gps.nmea", "can.log"))


def test_the_truths_grade_integrates_to_its_altitude(small: Path) -> None:
    """Within 5 cm over a lap with 7 % slopes, from the file's own digits."""
    truth = truth_of(small)
    steps_s = np.diff(truth["t_s"])
    climb_mps = truth["grade_pct"] / 100.0 * np.abs(truth["speed_mps"])
    climbed_m = np.cumsum((climb_mps[1:] + climb_mps[:-1]) / 2.0 * steps_s)
    assert np.ptp(truth["alt_m"]) > 20.0
    assert np.abs(truth["alt_m"][1:] - truth["alt_m"][0] - climbed_m).max() < 0.05


def test_the_truths_speed_and_heading_lead_along_its_positions(small: Path) -> None:
    """Dead reckoning with the truth comes back to the start of the loop within 2 cm.

    East counts in degrees, which are shorter in the north of the loop than in the south.
    """
    truth = truth_of(small)
    headings_rad = np.unwrap(np.radians(truth["heading_deg"]))
    middle_rad = (headings_rad[1:] + headings_rad[:-1]) / 2.0
    steps_m = (truth["speed_mps"][1:] + truth["speed_mps"][:-1]) / 2.0 * np.diff(truth["t_s"])
    lats_rad = np.radians(truth["lat_deg"])
    parallels = np.cos(lats_rad) / np.cos(lats_rad[0])
    north_m = np.sum(steps_m * np.cos(middle_rad))
    east_m = np.sum(steps_m * np.sin(middle_rad) * 2.0 / (parallels[1:] + parallels[:-1]))
    assert steps_m.sum() == pytest.approx(4000.0, abs=0.5)
    assert np.hypot(east_m, north_m) < 0.02


def test_a_drive_replays_near_its_truth(small: Path, tmp_path: Path) -> None:
    """Nothing refused, and the poses are where the truck was."""
    summary = replay(small, tmp_path)
    assert set(summary.bad_input.values()) == {0}
    errors = compared(read_replay(small, tmp_path).estimates, needed_truth(small))
    assert np.nanpercentile(errors.horizontal_m, 95) < 8.0
    assert np.nanpercentile(np.abs(errors.heading_deg), 95) < 3.0


def test_damage_is_counted_and_the_rest_goes_through(tmp_path: Path) -> None:
    """Torn, flipped, glued, late and repeated input never ends a replay."""
    damaged = load_scenario("damaged-input")
    damaged = overlaid(damaged, {"road": {"length_m": 2000.0}})
    simulate(damaged, tmp_path / "drive")
    summary = replay(tmp_path / "drive", tmp_path / "out")
    assert summary.bad_input["gps-ingest"] > 20
    assert summary.counts["gps_fix"] > 0.9 * summary.duration_s


def test_runs_of_a_road_lie_beside_each_other(tmp_path: Path) -> None:
    """Each is a drive of its own over the same kilometres."""
    simulate(overlaid(SMALL, {"runs": 2}), tmp_path)
    drives = [load_drive(tmp_path / f"run-{number}") for number in (1, 2)]
    assert drives[0].drive.vehicle_id == drives[1].drive.vehicle_id
    ends = [needed_truth(tmp_path / f"run-{number}").distances_m[-1] for number in (1, 2)]
    assert ends[0] == pytest.approx(ends[1], abs=1.0)


def test_a_simulated_drive_is_a_road_for_another(small: Path, tmp_path: Path) -> None:
    """`--road FOLDER` follows an earlier drive."""
    along = overlaid(Scenario(), {"road": {"kind": "file", "path": str(small)}})
    simulate(along, tmp_path)
    lengths_m = [needed_truth(folder).distances_m[-1] for folder in (small, tmp_path)]
    assert lengths_m[1] == pytest.approx(lengths_m[0], rel=0.01)


def test_a_receiver_alone_makes_a_drive_without_a_bus(tmp_path: Path) -> None:
    """No CAN log, no [[can]]."""
    simulate(overlaid(SMALL, {"sensors": ["gps"]}), tmp_path)
    assert not (tmp_path / "can.log").exists()
    assert not load_drive(tmp_path).can
    assert sum(1 for _ in DriveStream(load_drive(tmp_path), str(tmp_path))) > 100


@pytest.mark.parametrize("scenario", sorted(PAPER_PCT))
def test_four_runs_of_the_thesis_truck_spread_as_in_its_tables(
    scenario: str, tmp_path: Path
) -> None:
    """Each sensor alone, by the filter of papers/004, within 0.03 % of tables 5.1 and 5.2."""
    drives = simulate(load_scenario(scenario), tmp_path)
    folders = [drive.folder for drive in drives]
    assert spreads_pct(folders) == pytest.approx(PAPER_PCT[scenario], abs=0.03)


def spreads_pct(folders: Sequence[Path]) -> dict[str, float | None]:
    truths: list[Reference] = [needed_truth(folder) for folder in folders]
    runs = [thesis_grades(sense(load_drive(folder), folder)) for folder in folders]
    return {way: average_std(grades) for way, grades in profiles_of(truths, runs).ways.items()}
