"""Eta with timetables in its configuration."""

from argparse import Namespace
from pathlib import Path

import pytest

from unit.eta.route_drives import SECOND_NS, START_NS, route_of
from unit.timetable.faulty_feeds import FAULTS, good_feed, write_folder
from wayline.inputs import Tick
from wayline.messages import GpsFix
from wayline.route_file import write_route
from wayline.settings import Settings, VehicleAssignment
from wayline_eta.__main__ import build
from wayline_eta.core import EtaCore
from wayline_eta.timetable_core import TimetableEtaCore


def test_feeds_make_cores_of_timetables(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """What was mended, and a block that no feed has, is said when it starts."""
    tables = good_feed()
    next(fault for fault in FAULTS if fault.name == "doubled").put(tables)
    settings = Settings(
        vehicles=("*",),
        feeds=(str(write_folder(tables, tmp_path)),),
        assignment=(VehicleAssignment(vehicle_id="bus-1", block_id="nobody"),),
    )
    service = build(settings, Namespace())
    assert isinstance(service.make_node("bus-1", "").core, TimetableEtaCore)
    said = capsys.readouterr().err
    assert "are there twice" in said
    assert "[assignment] nobody: no feed has such a trip or block" in said


def test_a_calendar_that_has_ended_is_said_at_the_start_and_in_health(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """One line that names the feed and its last day."""
    tables = good_feed()
    tables["calendar.txt"] = tables["calendar.txt"].replace("20261231", "20260131")
    folder = write_folder(tables, tmp_path)
    service = build(Settings(vehicles=("*",), feeds=(str(folder),)), Namespace())
    expected = f"no service runs any longer by {folder} (last day 2026-01-31): name a newer feed"
    assert service.notice() == expected
    assert f"warning: {expected}" in capsys.readouterr().err


def test_a_database_that_is_away_stops_no_start(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The feed is read anew, and that is said."""
    settings = Settings(
        vehicles=("*",),
        feeds=(str(write_folder(good_feed(), tmp_path)),),
        database_url=f"sqlite:///{tmp_path}/away/eta.db",
    )
    build(settings, Namespace())
    assert "is read anew" in capsys.readouterr().err


def test_a_vehicle_that_is_assigned_to_a_route_follows_it_whatever_feeds_there_are(
    tmp_path: Path,
) -> None:
    """The others run the timetable's trips."""
    route = route_of([(0, 0), (1000, 0)], route_id="pier")
    write_route(route, tmp_path / "route.geojson")
    settings = Settings(
        vehicles=("*",),
        routes=(str(tmp_path / "route.geojson"),),
        feeds=(str(write_folder(good_feed(), tmp_path / "feed")),),
        assignment=(VehicleAssignment(vehicle_id="truck", route_id="pier"),),
    )
    service = build(settings, Namespace())
    assert isinstance(service.make_node("truck", "").core, EtaCore)
    assert isinstance(service.make_node("bus-1", "").core, TimetableEtaCore)


@pytest.mark.parametrize("by_timetable", [True, False])
def test_reports_of_two_vehicles_with_one_id_are_counted_in_health(
    tmp_path: Path, by_timetable: bool
) -> None:
    """One of them is followed; each report of the other, ten kilometres off, is bad input."""
    route = tmp_path / "r.geojson"
    write_route(route_of([(0, 0), (2_000, 0)]), route)
    feed = write_folder(good_feed(), tmp_path / "feed")
    feeds, routes = ((str(feed),), ()) if by_timetable else ((), (str(route),))
    service = build(Settings(vehicles=("*",), feeds=feeds, routes=routes), Namespace())
    node = service.make_node("bus-1", "")
    for report in range(20):
        lat_deg = 56.0 + (0.1 if report % 2 else 0.0)
        t_ns = START_NS + report * 30 * SECOND_NS
        fix = GpsFix(t_ns=t_ns, valid=True, lat_deg=lat_deg, lon_deg=10.0)
        list(node.take(fix, "gps-ingest"))
        list(node.give(Tick(t_ns), "eta"))
    assert service.bad_input() == 10
