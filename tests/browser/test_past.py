"""The page's past: a day's trips, a slider that the map follows, events, files, the trail."""

import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Page, expect

from browser.conftest import Watched
from unit.history.driven import LAT_DEG, LON_DEG, kept_of
from wayline.database import open_database
from wayline.gpx import read_gpx
from wayline.http_server import HttpServer
from wayline.http_settings import HttpSettings
from wayline.keys import FLEET
from wayline.messages import Message, Pose
from wayline.view import Receipt
from wayline_dashboard.app import create_dashboard
from wayline_dashboard.live_view import LiveView
from wayline_history.app import create_history_app
from wayline_history.archive import Archive
from wayline_history.store import HistoryStore

VEHICLE = "bus-7"
SECOND_NS = 1_000_000_000
STEP_DEG = 1.0e-4
"""Eastward each second: 7.4 m."""
DRIVE_S, AGO_S = 600, 3_000


def driven(now_ns: int) -> Iterator[Pose]:
    """Ten minutes due east that began fifty minutes ago, with half a minute without fixes."""
    for second in range(DRIVE_S):
        yield Pose(
            t_ns=now_ns - (AGO_S - second) * SECOND_NS,
            mode="dead_reckoning" if 300 <= second < 330 else "fused",
            lat_deg=LAT_DEG,
            lon_deg=LON_DEG + STEP_DEG * second,
            speed_mps=7.4,
            heading_deg=90.0,
            distance_m=7.4 * second,
            east_std_m=1.0,
            north_std_m=1.0,
        )


@pytest.fixture
def url(tmp_path: Path) -> Iterator[str]:
    """The page of a vehicle that stands now and drove within the last hour."""
    now_ns = time.time_ns()
    database = f"sqlite:///{tmp_path}/history.db"
    engine = open_database(database, "wayline_history")
    drive: list[Message] = list(driven(now_ns))
    HistoryStore(engine, time.time).save((VEHICLE, piece) for piece in kept_of(drive).pieces)
    engine.dispose()
    settings = HttpSettings(port=0)
    live = LiveView()
    now = Pose(t_ns=now_ns, mode="fused", lat_deg=LAT_DEG, lon_deg=LON_DEG + STEP_DEG * DRIVE_S)
    live.put(VEHICLE, now, "fusion", Receipt(time.monotonic_ns()))
    live.put_service(FLEET, "history", up=True)
    with HttpServer(create_history_app(Archive(database), settings), settings) as history:
        page = create_dashboard(live, settings, history_url=history.url)
        with HttpServer(page, settings) as server:
            yield server.url


def await_vehicle_at(page: Page, lon_deg: float) -> None:
    """Wait until the map draws the vehicle there: it draws a moment after it was told."""
    page.wait_for_function(
        "lon => Math.abs(window.wayline.map.getSource('vehicles').serialize().data"
        ".features[0].geometry.coordinates[0] - lon) < 1e-5",
        arg=lon_deg,
    )


def look_back(watched: Watched, url: str) -> Page:
    page = watched.page
    page.goto(url)
    page.locator("#past-open").click()
    expect(page.locator("#past-trips button")).to_have_count(1)
    return page


def replay_trip(page: Page) -> None:
    """Choose the trip, and wait for its track: what came before it is thrown away then."""
    with page.expect_response(lambda answer: "/track?" in answer.url):
        page.locator("#past-trips button").click()
    expect(page.locator("#past")).to_have_attribute("aria-busy", "false")
    expect(page.locator("#past-pose")).to_contain_text("27 km/h")


def test_a_trip_is_replayed_on_the_map_which_follows(watched: Watched, url: str) -> None:
    page = look_back(watched, url)
    replay_trip(page)
    await_vehicle_at(page, LON_DEG)
    page.locator("#past-speed").select_option("300")
    page.locator("#past-play").click()
    expect(page.locator("#past-play")).to_have_text("Play")
    await_vehicle_at(page, LON_DEG + STEP_DEG * (DRIVE_S - 1))
    page.wait_for_function(
        "lon => Math.abs(window.wayline.map.getCenter().lng - lon) < 1e-4",
        arg=LON_DEG + STEP_DEG * (DRIVE_S - 1),
    )


def test_the_slider_goes_by_keys_a_second_each(watched: Watched, url: str) -> None:
    page = look_back(watched, url)
    replay_trip(page)
    slider = page.locator("#past-slider")
    slider.focus()
    before = float(slider.input_value())
    for _ in range(5):
        page.keyboard.press("ArrowRight")
    expect(slider).to_have_value(f"{before + 5_000:.0f}")
    await_vehicle_at(page, LON_DEG + 5 * STEP_DEG)


def test_an_event_is_gone_to(watched: Watched, url: str) -> None:
    page = look_back(watched, url)
    page.locator("#past-events button", has_text="No fixes").click()
    expect(page.locator("#past-pose")).to_contain_text("Dead reckoning")


def test_the_stretch_is_saved_as_a_file_that_others_read(
    watched: Watched, url: str, tmp_path: Path
) -> None:
    page = look_back(watched, url)
    replay_trip(page)
    with page.expect_download() as download:
        page.locator("#past-files button", has_text="GPX").click()
    path = tmp_path / "track.gpx"
    download.value.save_as(path)
    (line,) = read_gpx(path)
    assert len(line.points) == pytest.approx(DRIVE_S, abs=2)


def test_the_trail_from_before_the_server_was_started_is_there(watched: Watched, url: str) -> None:
    page = watched.page
    page.goto(url)
    page.wait_for_function(
        "() => window.wayline.map.getSource('trail')?.serialize().data.features"
        ".some(({ geometry }) => geometry.coordinates.length > 50)"
    )
    assert watched.complaints == []


def test_back_to_live_shows_the_present(watched: Watched, url: str) -> None:
    page = look_back(watched, url)
    expect(page.locator(".line-state")).to_have_text("past")
    page.locator("#past-close").click()
    expect(page.locator(".line-state")).to_have_text("live")
    await_vehicle_at(page, LON_DEG + STEP_DEG * DRIVE_S)
