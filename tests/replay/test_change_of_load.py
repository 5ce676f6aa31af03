"""A truck that is unloaded or loaded on its way: from the drive's files to the mass."""

import json
from pathlib import Path

import numpy as np
import pytest

from wayline_replay.replay import replay
from wayline_simulator.drive_folder import simulate
from wayline_simulator.scenario import Scenario, overlaid

CHANGED_M, FOUND_WITHIN_M = 5_000.0, 3_000.0


def drive(folder: Path, before_kg: float, after_kg: float, wait_s: float) -> None:
    """Over hills; the engine's torque has no error of its own, which nothing tells from a mass."""
    asked = {
        "seed": 57,
        "mass_kg": before_kg,
        "loads": [{"distance_m": CHANGED_M, "mass_kg": after_kg, "wait_s": wait_s}],
        "torque": {"gain_std": 0.0, "gain_wander_std": 0.0, "mass_error_std": 0.0},
        "road": {"kind": "hills", "length_m": 10_000.0},
    }
    simulate(overlaid(Scenario(preset="thesis", vehicle="truck"), asked), folder)


def masses_kg(folder: Path, out: Path) -> tuple[np.ndarray, np.ndarray]:
    """Distance and mass at each status that tells one."""
    replay(folder, out)
    poses, rows = (
        [json.loads(line) for line in (out / f"{topic}.jsonl").read_text().splitlines()]
        for topic in ("pose", "fusion_status")
    )
    known = [row for row in rows if row["mass_kg"] is not None]
    way_m = np.interp(
        [row["t_ns"] for row in known],
        [pose["t_ns"] for pose in poses],
        [pose["distance_m"] for pose in poses],
    )
    return way_m, np.array([row["mass_kg"] for row in known])


@pytest.mark.parametrize(
    ("before_kg", "after_kg", "wait_s"),
    [(40_000.0, 16_000.0, 600.0), (16_000.0, 36_000.0, 180.0), (26_000.0, 31_000.0, 400.0)],
)
def test_another_load_is_found_within_three_kilometres(
    tmp_path: Path, before_kg: float, after_kg: float, wait_s: float
) -> None:
    drive(tmp_path / "drive", before_kg, after_kg, wait_s)
    way_m, mass_kg = masses_kg(tmp_path / "drive", tmp_path / "out")
    assert mass_kg[way_m < CHANGED_M][-1] == pytest.approx(before_kg, rel=0.06)
    found_kg = mass_kg[way_m > CHANGED_M + FOUND_WITHIN_M]
    assert found_kg == pytest.approx(np.full(len(found_kg), after_kg), rel=0.06)


def test_a_stand_alone_changes_no_mass(tmp_path: Path) -> None:
    drive(tmp_path / "drive", 30_000.0, 30_000.0, 600.0)
    way_m, mass_kg = masses_kg(tmp_path / "drive", tmp_path / "out")
    settled = (way_m > 3_000.0) & (way_m < CHANGED_M) | (way_m > CHANGED_M + 1_000.0)
    assert mass_kg[settled] == pytest.approx(np.full(settled.sum(), 30_000.0), rel=0.06)
