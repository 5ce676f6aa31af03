"""Routes, trips and stops of timetables over HTTP."""

from pathlib import Path

import pytest
from fastapi.testclient import TestClient

from unit.eta.route_drives import route_of
from unit.timetable.faulty_feeds import good_feed, write_folder
from wayline.http_settings import HttpSettings
from wayline.timetable.reading import read_timetable
from wayline_eta.app import create_eta_app
from wayline_eta.board import EtaBoard


def client(folder: Path, **changed: str) -> TestClient:
    tables = good_feed() | {f"{name}.txt": text for name, text in changed.items()}
    timetable = read_timetable(write_folder(tables, folder))
    app = create_eta_app(EtaBoard(), [], HttpSettings(), timetables=[timetable])
    return TestClient(app, base_url="http://localhost")


def test_routes_are_the_feed_s(tmp_path: Path) -> None:
    [route] = client(tmp_path).get("/v1/routes").json()["routes"]
    assert route == {
        "route_id": "R",
        "name": "1",
        "loop": False,
        "length_m": pytest.approx(4_003.0, abs=1.0),
        "stops": 5,
        "href": "/v1/routes/R",
    }


def test_a_route_s_geojson_has_its_patterns_and_stops(tmp_path: Path) -> None:
    answer = client(tmp_path).get("/v1/routes/R")
    assert answer.headers["content-type"].startswith("application/geo+json")
    kinds = [feature["geometry"]["type"] for feature in answer.json()["features"]]
    assert kinds == ["LineString", *["Point"] * 5]


def test_routes_of_files_are_told_beside_the_feed_s(tmp_path: Path) -> None:
    """Vehicles may be assigned to either."""
    feed = read_timetable(write_folder(good_feed(), tmp_path))
    own = route_of([(0.0, 0.0), (500.0, 0.0)], route_id="shuttle")
    app = create_eta_app(EtaBoard(), [own], HttpSettings(), timetables=[feed])
    there = TestClient(app, base_url="http://localhost")
    listed = there.get("/v1/routes").json()["routes"]
    assert [route["route_id"] for route in listed] == ["shuttle", "R"]
    assert all(there.get(route["href"]).status_code == 200 for route in listed)


def test_a_trip_has_its_stops_and_times(tmp_path: Path) -> None:
    trip = client(tmp_path).get("/v1/trips/U").json()
    assert (trip["route_id"], trip["direction_id"], trip["block_id"]) == ("R", 0, "B")
    assert (trip["timezone"], trip["headway_s"]) == ("Europe/Berlin", None)
    assert [stop["stop_id"] for stop in trip["stops"]] == [f"S{at}" for at in range(5)]
    assert [stop["arrival"] for stop in trip["stops"]][:2] == ["09:00:00", "09:02:00"]


def test_a_repeated_trip_tells_its_first_run_and_its_headway(tmp_path: Path) -> None:
    frequencies = "trip_id,start_time,end_time,headway_secs\nU,25:10:00,26:10:00,600\n"
    trip = client(tmp_path, frequencies=frequencies).get("/v1/trips/U").json()
    assert trip["headway_s"] == 600
    assert trip["stops"][0]["departure"] == "25:10:00"


def test_the_feed_s_stops_have_arrivals(tmp_path: Path) -> None:
    there = client(tmp_path)
    assert there.get("/v1/stops/S1/arrivals").json() == {"arrivals": []}
    assert there.get("/v1/stops/nowhere/arrivals").status_code == 404


@pytest.mark.parametrize("path", ["/v1/routes/Q", "/v1/trips/nobody"])
def test_what_no_feed_has_is_not_found(tmp_path: Path, path: str) -> None:
    answer = client(tmp_path).get(path)
    assert answer.status_code == 404
    assert answer.headers["content-type"] == "application/problem+json"
