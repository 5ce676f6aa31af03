"""The past over HTTP: tracks in four forms, trips, events, and refusals that say what to mend."""

import csv
import io
import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from xml.etree import ElementTree as XmlTree

import pytest
from fastapi.testclient import TestClient

from builders import at, fix
from unit.history.driven import LAT_DEG, LON_DEG, METRES_PER_DEGREE, VEHICLE, legs, pose
from unit.history.keeping import History
from wayline.gpx import read_gpx
from wayline.http_settings import HttpSettings
from wayline.rfc3339 import rfc3339
from wayline_history.app import create_history_app
from wayline_history.archive import Archive

TRACK = f"/v1/vehicles/{VEHICLE}/track"
FROM_START = {"from": rfc3339(at(0)), "to": rfc3339(at(3600))}


@pytest.fixture
def url(tmp_path: Path) -> str:
    return f"sqlite:///{tmp_path}/history.db"


@pytest.fixture
def history(url: str) -> Iterator[History]:
    opened = History(url)
    yield opened
    opened.engine.dispose()


@pytest.fixture
def http(history: History, url: str) -> TestClient:
    history.keep([*legs((60, 0.0), (100, 10.0), (40, 0.0), (100, 10.0))])
    history.keep([fix(second, LAT_DEG, LON_DEG, alt_m=501.5) for second in range(5)])
    return client(url)


def client(url: str, settings: HttpSettings | None = None) -> TestClient:
    app = create_history_app(Archive(url), settings or HttpSettings(), now_ns=lambda: at(4 * 3600))
    return TestClient(app, base_url="http://localhost")


def asked(http: TestClient, path: str, **parameters: Any) -> Any:
    answer = http.get(path, params=FROM_START | parameters)
    assert answer.status_code == 200, answer.text
    return answer.json()


def test_a_track_holds_the_poses_in_order_of_time(http: TestClient) -> None:
    track = asked(http, TRACK)
    assert (track["vehicle_id"], track["kind"], track["next"]) == (VEHICLE, "fused", None)
    assert [point["t"] for point in track["points"]] == [rfc3339(at(s)) for s in range(300)]
    assert track["points"][70]["lat_deg"] == LAT_DEG
    assert track["points"][70]["mode"] == "fused"


def test_pages_of_a_track_make_the_whole(http: TestClient) -> None:
    whole = asked(http, TRACK)["points"]
    first = asked(http, TRACK, limit=130)
    assert first["points"] == whole[:130]
    second = asked(http, TRACK, **{"from": first["next"]})
    assert second["points"] == whole[130:]


def test_a_step_leaves_one_point_in_so_many_seconds(http: TestClient) -> None:
    points = asked(http, TRACK, step_s=60)["points"]
    assert [point["t"][14:] for point in points] == [
        "13:20.000Z", "14:00.000Z", "15:00.000Z", "16:00.000Z", "17:00.000Z", "18:00.000Z",
    ]  # fmt: skip


def test_raw_fixes_stand_beside_the_poses(http: TestClient) -> None:
    points = asked(http, TRACK, kind="raw")["points"]
    assert len(points) == 5
    assert (points[0]["source"], points[0]["alt_m"]) == ("test", 501.5)


def test_without_bounds_the_day_before_now_is_told(http: TestClient) -> None:
    answer = http.get(TRACK).json()
    assert (answer["from"], answer["to"]) == (rfc3339(at(-20 * 3600)), rfc3339(at(4 * 3600)))
    assert len(answer["points"]) == 300


def test_a_table_has_a_header_and_a_row_a_point(http: TestClient) -> None:
    answer = http.get(f"{TRACK}.csv", params=FROM_START)
    assert answer.headers["content-type"] == "text/csv; charset=utf-8"
    rows = list(csv.DictReader(io.StringIO(answer.text)))
    assert len(rows) == 300
    assert rows[0]["t"] == rfc3339(at(0))
    assert rows[0]["grade_pct"] == ""


def test_gpx_is_read_by_the_reader_of_routes(http: TestClient, tmp_path: Path) -> None:
    answer = http.get(f"{TRACK}.gpx", params=FROM_START)
    XmlTree.fromstring(answer.text)
    path = tmp_path / "track.gpx"
    path.write_bytes(answer.content)
    (line,) = read_gpx(path)
    assert (line.name, len(line.points)) == (VEHICLE, 300)
    assert line.points[0].alt_m == 500.0
    assert line.points[0].time is not None


def test_geojson_has_lines_and_their_times(http: TestClient) -> None:
    collection = json.loads(http.get(f"{TRACK}.geojson", params=FROM_START).content)
    (feature,) = collection["features"]
    (line,) = feature["geometry"]["coordinates"]
    (times,) = feature["properties"]["coordTimes"]
    assert len(line) == len(times) == 300
    assert line[0] == [LON_DEG, LAT_DEG, 500.0]


def test_a_track_over_the_antimeridian_is_two_lines(history: History, url: str) -> None:
    drive = [
        pose(s, 0.0, 10.0, lon_deg=(179.9995 + 1e-4 * s + 180.0) % 360.0 - 180.0, distance_m=s)
        for s in range(11)
    ]
    history.keep(drive)
    collection = json.loads(client(url).get(f"{TRACK}.geojson", params=FROM_START).content)
    (feature,) = collection["features"]
    east, west = feature["geometry"]["coordinates"]
    assert all(position[0] > 179 for position in east)
    assert all(position[0] < -179 for position in west)
    assert len(east) + len(west) == 11


def test_silence_begins_another_line_and_a_lone_place_is_one_too(
    history: History, url: str
) -> None:
    history.keep([pose(0, 0, 0), pose(1, 0, 0), pose(1800, 0, 0)])
    http = client(url)
    collection = json.loads(http.get(f"{TRACK}.geojson", params=FROM_START).content)
    lines = collection["features"][0]["geometry"]["coordinates"]
    assert [len(line) for line in lines] == [2, 2]
    assert http.get(f"{TRACK}.gpx", params=FROM_START).text.count("<trkseg>") == 2


def test_where_nothing_is_kept_documents_are_whole_and_empty(http: TestClient) -> None:
    nothing = {"from": rfc3339(at(7200)), "to": rfc3339(at(7300))}
    assert http.get(TRACK, params=nothing).json()["points"] == []
    assert len(http.get(f"{TRACK}.csv", params=nothing).text.splitlines()) == 1
    collection = json.loads(http.get(f"{TRACK}.geojson", params=nothing).content)
    assert collection["features"][0]["geometry"]["coordinates"] == []
    XmlTree.fromstring(http.get(f"{TRACK}.gpx", params=nothing).text)


def test_trips_and_one_trip(http: TestClient) -> None:
    (trip,) = asked(http, f"/v1/vehicles/{VEHICLE}/trips")["trips"]
    assert (trip["vehicle_id"], trip["started"]) == (VEHICLE, rfc3339(at(59)))
    assert trip["under_way"] is False
    assert trip["start_lon_deg"] == pytest.approx(LON_DEG, abs=1e-7)
    assert trip["end_lon_deg"] == pytest.approx(LON_DEG + 1990.0 / METRES_PER_DEGREE, abs=1e-6)
    assert trip["stops"] == [
        {"started": rfc3339(at(160)), "dwell_s": 40.0, "lat_deg": LAT_DEG,
         "lon_deg": pytest.approx(LON_DEG, abs=0.1)},
    ]  # fmt: skip
    assert http.get(f"/v1/vehicle-trips/{trip['trip_key']}").json() == trip
    assert http.get("/v1/vehicle-trips/bus-7_1").status_code == 404


def test_events_in_pages(http: TestClient) -> None:
    events = asked(http, f"/v1/vehicles/{VEHICLE}/events")
    assert [event["kind"] for event in events["events"]] == ["mode"]
    assert events["next"] is None


@pytest.mark.parametrize(
    ("parameters", "name", "words"),
    [
        ({"from": "2015-01-01", "to": "2025-01-01"}, "from", "ask in parts"),
        ({"from": "2025-01-02", "to": "2025-01-01"}, "from", "is not before to"),
        ({"from": "yesterday"}, "from", "is no time"),
        ({"to": "1e30"}, "to", "between 1980 and 2100"),
        ({"to": "inf"}, "to", "is no time"),
        ({"kind": "cooked"}, "kind", "cooked"),
        ({"step_s": "-1"}, "step_s", ">= 0"),
        ({"step_s": "nan"}, "step_s", "Expected"),
        ({"limit": "0"}, "limit", ">= 1"),
        ({"limit": "many"}, "limit", "int"),
    ],
)
def test_an_unfit_question_is_a_problem_that_names_it(
    http: TestClient, parameters: dict[str, str], name: str, words: str
) -> None:
    answer = http.get(TRACK, params=parameters)
    assert answer.status_code == 422
    assert answer.headers["content-type"] == "application/problem+json"
    (invalid,) = answer.json()["invalid"]
    assert invalid["name"] == name
    assert words in invalid["reason"]


def test_ten_years_of_trips_are_refused_too(http: TestClient) -> None:
    ten_years = {"from": "2015-01-01", "to": "2025-01-01"}
    for path in ("trips", "events"):
        assert http.get(f"/v1/vehicles/{VEHICLE}/{path}", params=ten_years).status_code == 422


@pytest.mark.parametrize("path", ["track", "track.gpx", "track.geojson", "trips", "events"])
def test_a_vehicle_that_nobody_knows_is_said_to_be_so(http: TestClient, path: str) -> None:
    answer = http.get(f"/v1/vehicles/bus-99/{path}", params=FROM_START)
    assert answer.status_code == 404
    assert "bus-99" in answer.json()["detail"]


@pytest.mark.parametrize("name", ["%00", "Bus%207", "%C3%A9", "_fleet"])
def test_a_name_that_is_none_is_not_known(http: TestClient, name: str) -> None:
    assert http.get(f"/v1/vehicles/{name}/trips").status_code == 404
    assert http.get(f"/v1/vehicle-trips/{name}").status_code == 404


def test_an_unknown_form_is_a_problem(http: TestClient) -> None:
    assert http.get(f"{TRACK}.kml", params=FROM_START).status_code == 422


def test_a_foreign_token_is_refused(history: History, url: str) -> None:
    history.keep(legs((10, 1.0)))
    guarded = client(url, HttpSettings(tokens=("one-long-token-of-the-fleet",)))
    foreign = {"authorization": "Bearer of-another-fleet-altogether"}
    assert guarded.get(TRACK, headers=foreign).status_code == 401
    own = {"authorization": "Bearer one-long-token-of-the-fleet"}
    assert guarded.get(TRACK, params=FROM_START, headers=own).status_code == 200


def test_a_database_that_is_away_is_a_problem_and_comes_back(tmp_path: Path) -> None:
    away = tmp_path / "mounted-later"
    http = client(f"sqlite:///{away}/history.db")
    answer = http.get(TRACK, params=FROM_START)
    assert answer.status_code == 503
    assert "no folder" in answer.json()["detail"]
    away.mkdir()
    assert http.get(TRACK, params=FROM_START).status_code == 404


def test_zones_and_unix_seconds_are_understood(http: TestClient) -> None:
    zoned = asked(http, TRACK, **{"from": "2023-11-14T23:13:20+01:00"})
    seconds = asked(http, TRACK, **{"from": str(at(0) // 10**9)})
    spaced = asked(http, TRACK, **{"from": "2023-11-14 22:13:20"})
    assert zoned["from"] == seconds["from"] == spaced["from"] == rfc3339(at(0))
    unescaped = http.get(f"{TRACK}?from=2023-11-14T23:13:20+01:00").json()
    assert unescaped["from"] == rfc3339(at(0))
