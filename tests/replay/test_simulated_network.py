"""Buses of a simulated network that say nothing of their trips, from their reports on."""

from pathlib import Path

import pytest

from wayline_evaluation.eta_study import Followed, eta_study
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


def test_a_yardstick_tells_of_the_same_arrivals(tmp_path: Path) -> None:
    """A single trip: whose errors are smaller is chance, but not that both are small."""
    model = NetworkModel(seed=18, vehicles=1, hours=0.4, assigned=True)
    (day,) = simulate_network(model, tmp_path)
    followed = Followed(feeds=(tmp_path / "feed",))
    report, _ = eta_study([day.folder], followed, Options(yardstick=True), lambda _, __: None)
    assert report.yardstick is not None
    both = report.yardstick.told, report.yardstick.yardstick
    assert both[0].predictions == both[1].predictions > 100
    for score in both:
        errors_s = sum(span.count * (span.mean_absolute_s or 0.0) for span in score.spans)
        assert 0.0 < errors_s / score.predictions < 90.0
