"""The GTFS-Realtime feeds of simulated buses, as an independent validator reads them."""

import zipfile
from pathlib import Path

from gtfs_rt_validator.api import Mode, Request, resolve, validate

from realtime_day import replayed, write_feeds
from wayline_simulator.network.files import simulate_network
from wayline_simulator.network.model import NetworkModel


def test_a_validator_finds_no_error_in_the_feeds_of_some_hours(tmp_path: Path) -> None:
    """Every half minute both feeds, with their timetable; trips begin, end and follow each other.

    What is left to warn of are vehicles between their trips (W003).
    """
    model = NetworkModel(seed=3, vehicles=2, hours=0.7, every_s=30.0)
    feed = tmp_path / "feed"
    days = simulate_network(model, tmp_path)
    buses = [replayed(day.folder, feed, tmp_path / "out" / day.folder.name) for day in days]
    messages = write_feeds(buses, tmp_path / "messages", every_s=30)
    with zipfile.ZipFile(tmp_path / "feed.zip", "w") as archive:
        for table in feed.iterdir():
            archive.write(table, table.name)
    request = Request(Mode.MODERN, tmp_path / "feed.zip", resolve(str(tmp_path / "messages")))
    result = validate(request)
    assert result.run.messages_validated == messages > 80
    assert not result.error_ids()
    assert set(result.run.notices.rule_ids()) <= {"W003"}
