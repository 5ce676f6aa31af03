"""Buses of a simulated network that say nothing of their trips, from their reports on."""

from pathlib import Path

import pytest

from wayline_evaluation.replays import Options
from wayline_evaluation.trip_study import trip_study
from wayline_simulator.network.files import simulate_network
from wayline_simulator.network.model import NetworkModel


@pytest.mark.parametrize("every_s", [30.0, 60.0])
def test_trips_are_found_by_seldom_reports(tmp_path: Path, every_s: float) -> None:
    """Nearly always right a kilometre behind the fork, and never long the wrong way."""
    model = NetworkModel(seed=8, vehicles=2, hours=1.5, every_s=every_s)
    days = simulate_network(model, tmp_path)
    report = trip_study(
        [day.folder for day in days], [tmp_path / "feed"], Options(), lambda _, __: None
    )
    found = report.pooled
    assert found.alone_share is not None
    assert found.alone_share >= 0.98
    assert found.wrong_way_reports <= 2
    assert len(report.scores) == 2
