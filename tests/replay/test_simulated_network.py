"""Buses of a simulated network that say nothing of their trips, from their reports on."""

from pathlib import Path

import pytest

from wayline.errors import InputError
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


def test_arrivals_are_told_less_well_than_by_who_is_told_the_streets(tmp_path: Path) -> None:
    """Of the same arrivals; and some drives have no yardstick."""
    model = NetworkModel(seed=18, vehicles=1, hours=0.4, assigned=True)
    (day,) = simulate_network(model, tmp_path)
    followed = Followed(feeds=(tmp_path / "feed",))
    report, _ = eta_study([day.folder], followed, Options(yardstick=True), lambda _, __: None)
    assert report.yardstick is not None
    told, yardstick = report.yardstick.told, report.yardstick.yardstick
    assert told.predictions == yardstick.predictions > 100
    for own, other in zip(told.spans[:3], yardstick.spans[:3], strict=True):
        assert own.mean_absolute_s is not None
        assert other.mean_absolute_s is not None
        assert other.mean_absolute_s < own.mean_absolute_s
    (day.folder / "network.json").unlink()
    with pytest.raises(InputError, match="there is no yardstick for it"):
        eta_study([day.folder], followed, Options(yardstick=True), lambda _, __: None)
