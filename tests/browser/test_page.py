import math
import re
import time
from itertools import groupby
from typing import Any

import msgspec
import pytest
from playwright.sync_api import Page, expect

from browser.conftest import Stage, Watched
from browser.shuttle import SECOND_NS
from wayline.geo import step_between
from wayline.keys import FLEET
from wayline.messages import Health, Horizon, HorizonPoint
from wayline.services import SERVICES

TOKEN = "correct-horse-battery"


def open_page(stage: Stage, watched: Watched) -> Page:
    watched.page.goto(f"{stage.server.url}/")
    return watched.page


def state(page: Page, script: str) -> Any:
    return page.evaluate(f"() => {{ const {{ map, fleet }} = window.wayline; {script} }}")


def wait_for_map(page: Page) -> None:
    page.wait_for_function(
        "() => window.wayline.map.queryRenderedFeatures({ layers: ['vehicles'] }).length > 0"
    )


def test_arrivals_are_listed_soonest_first(stage: Stage, watched: Watched) -> None:
    page = open_page(stage, watched)
    rows = page.locator("#arrivals li")
    expect(rows).to_have_count(5)
    # a minute at 8 m/s is 480 m of the loop, past the first stop
    expect(rows.first).to_contain_text("Railway Station")
    stage.catch_up(600)
    expect(rows.first.locator(".countdown")).to_have_text(re.compile(r"in \d+ s|now"))
    ahead_m = stage.shuttle.route.stops[1].distance_m - 480.0
    expect(rows.first.locator(".stop-distance")).to_have_text(f"{ahead_m:.0f} m ahead")
    expect(rows.last).to_contain_text("College Avenue")
    expect(rows.last.locator(".countdown")).to_have_text("in 3 min")
    expect(rows.last.locator(".range")).to_have_text(re.compile(r"\(\d.\d\)"))


def test_the_mode_and_its_age_are_told(stage: Stage, watched: Watched) -> None:
    page = open_page(stage, watched)
    expect(page.locator("#mode")).to_have_text("Fused")
    expect(page.locator("#age")).to_contain_text("silent for")
    stage.catch_up(600)
    expect(page.locator("#age")).to_contain_text("updated")


def test_the_vehicle_is_drawn_where_it_is(stage: Stage, watched: Watched) -> None:
    page = open_page(stage, watched)
    wait_for_map(page)
    [drawn] = state(
        page,
        "return map.queryRenderedFeatures({ layers: ['vehicles'] })"
        ".map((found) => [found.geometry.coordinates, found.properties]);",
    )
    (lon_deg, lat_deg), properties = drawn
    wanted_lat_deg, wanted_lon_deg, heading_deg = stage.shuttle.place(599 * 0.8)
    # the map rounds to its tiles' own grid
    assert step_between(lat_deg, lon_deg, wanted_lat_deg, wanted_lon_deg).distance_m < 1.0
    assert properties["heading_deg"] == pytest.approx(heading_deg)
    assert properties["icon"] == "selected-arrow"
    pixels = page.locator("#map canvas").screenshot()
    assert len(set(pixels)) > 200


def test_following_keeps_a_moving_vehicle_in_the_middle(stage: Stage, watched: Watched) -> None:
    page = open_page(stage, watched)
    wait_for_map(page)
    stage.drive(600, 700)
    lat_deg, lon_deg, _ = stage.shuttle.place(699 * 0.8)
    page.wait_for_function(
        f"() => Math.hypot(window.wayline.map.getCenter().lng - {lon_deg},"
        f" window.wayline.map.getCenter().lat - {lat_deg}) < 1e-5"
    )
    page.locator("#follow").click()
    expect(page.locator("#follow")).to_have_attribute("aria-pressed", "false")
    stage.drive(700, 800)
    away = stage.shuttle.place(799 * 0.8)
    page.wait_for_function(
        "() => Math.abs(window.wayline.fleet.vehicles.get('shuttle-1').pose.lat_deg"
        f" - {away[0]}) < 1e-9"
    )
    assert state(page, "return map.getCenter().lat;") == pytest.approx(lat_deg, abs=1e-5)


def test_the_slope_by_sensor_is_listed_for_who_asks(stage: Stage, watched: Watched) -> None:
    page = open_page(stage, watched)
    expect(page.locator("#slopes dl")).to_be_hidden()
    page.locator("#slopes summary").click()
    expect(page.locator("#slopes dt")).to_have_text(["GPS altitude", "Barometer"])
    expect(page.locator("#slopes dd")).to_have_text(["\N{MINUS SIGN}1.3 ± 0.6 %", "+2.0 ± 0.2 %"])


def test_the_ellipse_has_its_size_in_metres(stage: Stage, watched: Watched) -> None:
    stage.drive(600, 1001)  # from second 90 on without GPS: it has grown
    page = open_page(stage, watched)
    expect(page.locator("#mode")).to_have_text("Dead reckoning")
    wait_for_map(page)
    outlines = state(
        page, "return map.querySourceFeatures('ellipse').map((f) => f.geometry.coordinates[0]);"
    )
    lat_deg, lon_deg, _ = stage.shuttle.place(100.0 * 8.0)
    radii_m = [
        step_between(lat_deg, lon_deg, corner[1], corner[0]).distance_m
        for outline in outlines
        for corner in outline
    ]
    across_m = (1.4 + 0.25 * 10.0) * math.sqrt(-2.0 * math.log(0.05))
    assert max(radii_m) == pytest.approx(across_m, abs=0.5)


def test_the_raw_fix_is_beside_the_pose_and_goes_with_gps(stage: Stage, watched: Watched) -> None:
    page = open_page(stage, watched)
    wait_for_map(page)
    shown = "() => window.wayline.map.queryRenderedFeatures({ layers: ['fix'] }).length === "
    page.wait_for_function(f"{shown} 1")
    stage.drive(600, 1001)
    page.wait_for_function(f"{shown} 0")


def test_route_and_stops_are_on_the_map(stage: Stage, watched: Watched) -> None:
    page = open_page(stage, watched)
    wait_for_map(page)
    page.locator("#overview").click()
    page.wait_for_function(
        "() => new Set(window.wayline.map.queryRenderedFeatures({ layers: ['stops'] })"
        ".map((found) => found.properties.name)).size === 5"
    )
    assert state(page, "return map.queryRenderedFeatures({ layers: ['route'] }).length;") > 0


def test_the_slope_ahead_is_a_chart_with_a_name(stage: Stage, watched: Watched) -> None:
    page = open_page(stage, watched)
    chart = page.get_by_role("img", name="over 1.5 km, 4 runs")
    expect(chart).to_be_visible()
    assert chart.locator(".grade").count() == 2  # a gap that nobody has driven splits it
    assert chart.locator(".band").count() == 2


def test_services_go_down_and_come_up(stage: Stage, watched: Watched) -> None:
    for service in SERVICES:
        stage.live.put_service("shuttle-1", service, up=True)
    page = open_page(stage, watched)
    expect(page.locator("#services-title")).to_contain_text("all up")
    stage.live.put_service("shuttle-1", "eta", up=False)
    expect(page.locator("#services-title")).to_contain_text("1 down")
    expect(page.locator("#services li", has_text="eta")).to_contain_text("down")


def test_of_several_vehicles_one_is_chosen_and_stays_in_the_address(
    stage: Stage, watched: Watched
) -> None:
    stage.drive(300, 301, "shuttle-2")
    page = open_page(stage, watched)
    expect(page.locator("#vehicle-title")).to_have_text("shuttle-1")
    page.get_by_role("button", name="shuttle-2").click()
    expect(page.locator("#vehicle-title")).to_have_text("shuttle-2")
    page.reload()
    expect(page.locator("#vehicle-title")).to_have_text("shuttle-2")


def test_the_slope_ahead_is_told_of_the_selected_vehicle_only(
    stage: Stage, watched: Watched
) -> None:
    stage.drive(300, 301, "shuttle-2")
    flat = HorizonPoint(distance_m=500.0, grade_pct=0.0, grade_std_pct=0.1, runs=1)
    points = (msgspec.structs.replace(flat, distance_m=0.0), flat)
    stage.put("shuttle-2", Horizon(t_ns=time.time_ns(), points=points), "slope-map")
    page = open_page(stage, watched)
    expect(page.get_by_role("img", name="over 1.5 km, 4 runs")).to_be_visible()
    stage.drive(600, 620)
    page.get_by_role("button", name="shuttle-2").click()
    expect(page.get_by_role("img", name="over 500 m, 1 run")).to_be_visible()
    stage.drive(620, 640)
    page.get_by_role("button", name="shuttle-1").click()
    expect(page.get_by_role("img", name="over 1.5 km, 4 runs")).to_be_visible()
    told = [name for name, _ in groupby(watched.told_whole())]
    assert told == ["shuttle-1", "shuttle-2", "shuttle-1"]
    assert watched.complaints == []


def test_a_forgotten_vehicle_leaves_list_map_and_panel_until_it_is_heard_again(
    stage: Stage, watched: Watched
) -> None:
    stage.drive(300, 301, "shuttle-2")
    page = open_page(stage, watched)
    page.get_by_role("button", name="shuttle-2").click()
    expect(page.locator("#vehicle-title")).to_have_text("shuttle-2")
    page.locator("#overview").click()
    drawn = (
        "() => window.wayline.map.queryRenderedFeatures({ layers: ['vehicles'] })"
        ".map((found) => found.properties.vehicle_id).sort().join() === "
    )
    page.wait_for_function(f"{drawn} 'shuttle-1,shuttle-2'")
    stage.live.forget("shuttle-2")
    expect(page.locator("#vehicle-title")).to_have_text("shuttle-1")
    expect(page.locator("#vehicles")).to_have_count(0)
    expect(page.locator("#arrivals li")).to_have_count(5)
    page.wait_for_function(f"{drawn} 'shuttle-1'")
    stage.drive(310, 311, "shuttle-2")
    expect(page.locator("#vehicle-title")).to_have_text("shuttle-2")
    expect(page.locator("#arrivals li")).to_have_count(5)
    page.wait_for_function(f"{drawn} 'shuttle-1,shuttle-2'")


def test_a_step_of_the_servers_clock_makes_nothing_older(stage: Stage, watched: Watched) -> None:
    page = open_page(stage, watched)
    stage.catch_up(600)
    expect(page.locator("#age")).to_contain_text("updated")
    stage.clock_step_ns = 3600 * SECOND_NS
    stage.live.put_service(FLEET, "eta", up=True)
    expect(page.locator("#services")).to_contain_text("eta")
    expect(page.locator("#age")).to_have_text(
        re.compile(r"^(updated|silent for) (less than )?\d+ s")
    )


def test_a_lost_connection_is_said_and_comes_back(stage: Stage, watched: Watched) -> None:
    page = open_page(stage, watched)
    expect(page.locator("#mode")).to_have_text("Fused")
    stage.stop()
    expect(page.locator("#banner")).to_contain_text("Connection lost")
    expect(page.locator(".line-state")).to_have_text("not live")
    stage.drive(600, 1001)
    stage.restart()
    expect(page.locator("#banner")).to_be_empty()
    expect(page.locator("#mode")).to_have_text("Dead reckoning")


def test_a_guarded_dashboard_asks_for_its_token(stage: Stage, watched: Watched) -> None:
    stage.stop()
    stage.restart(tokens=(TOKEN,))
    page = open_page(stage, watched)
    page.get_by_label("Access token").fill("wrong")
    page.get_by_role("button", name="Open").click()
    expect(page.get_by_role("alert")).to_have_text("That token is not accepted.")
    page.get_by_label("Access token").fill(TOKEN)
    page.get_by_role("button", name="Open").click()
    expect(page.locator("#mode")).to_have_text("Fused")


def test_a_recording_counts_on_its_own_clock(stage: Stage, watched: Watched) -> None:
    stage.shuttle.start_ns = 1_542_031_402 * SECOND_NS  # 2018-11-12
    for step in range(100):
        for message, source in stage.shuttle.messages(step):
            stage.put("archive", message, source, recorded=True)
    played = Health(
        t_ns=time.time_ns(), service="wayline-play", version="0", started_ns=0, recorded=True
    )
    stage.put("archive", played, "wayline-play")
    page = open_page(stage, watched)
    expect(page.locator("#age")).to_contain_text("recording of 12 Nov 2018")
    expect(page.locator("#arrivals .countdown").first).to_contain_text("in ")


def test_on_a_phone_nothing_is_wider_than_the_screen(stage: Stage, watched: Watched) -> None:
    watched.page.set_viewport_size({"width": 390, "height": 844})
    page = open_page(stage, watched)
    expect(page.locator("#arrivals li")).to_have_count(5)
    assert page.evaluate("document.documentElement.scrollWidth") == 390
    frame, panel = page.locator("#map-frame").bounding_box(), page.locator("#panel").bounding_box()
    assert frame is not None
    assert panel is not None
    assert frame["height"] > 300
    assert panel["y"] >= frame["y"] + frame["height"] - 1


def test_the_page_asks_nobody_else_and_complains_of_nothing(stage: Stage, watched: Watched) -> None:
    page = open_page(stage, watched)
    wait_for_map(page)
    page.emulate_media(color_scheme="dark")
    wait_for_map(page)
    foreign = {url for url in watched.requested if not url.startswith(stage.server.url)}
    assert foreign == set()
    assert watched.complaints == []


def test_the_documentation_draws_itself_without_the_internet(
    stage: Stage, watched: Watched
) -> None:
    watched.page.goto(f"{stage.server.url}/docs")
    expect(watched.page.locator(".opblock")).to_have_count(8)
    assert watched.complaints == []
    assert {url for url in watched.requested if not url.startswith(stage.server.url)} == set()
