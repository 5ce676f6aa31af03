"""Roads and profiles over HTTP: the core's own numbers, unknown as null, refusals."""

import csv
import io
import itertools

import numpy as np
import pytest

from unit.slope_map.asking import NOW_NS, asked, client, path_of
from unit.slope_map.hilly_road import (
    true_grade_pct,
)
from wayline.digits import rounded
from wayline.errors import InputError
from wayline.http_settings import HttpSettings
from wayline.line import Line
from wayline.rfc3339 import rfc3339
from wayline_slope_map.book import SlopeBook
from wayline_slope_map.profile import RoadProfile
from wayline_slope_map.questions import POINTS_MAX
from wayline_slope_map.roads import Road

TOKEN = "correct-horse-battery"


def test_roads_are_listed_with_what_is_known_of_them(book: SlopeBook, profile: RoadProfile) -> None:
    [road] = asked(book, "/v1/roads")["roads"]
    expected = {
        "road_id": profile.road.road_id,
        "length_m": profile.road.line.length_m,
        "bin_m": 20.0,
        "loop": False,
        "is_route": False,
        "directions": [
            {
                "direction": way,
                "known_m": min(20.0 * len(profile.bins[direction]), profile.road.line.length_m),
                "runs": 1,
                "updated": rfc3339(profile.bins[direction][50].updated_ns),
            }
            for way, direction in (("forward", 1), ("backward", -1))
        ],
        "href": f"/v1/roads/{profile.road.road_id}/profile",
    }
    assert road == rounded(expected)
    assert road["directions"][0]["updated"].startswith("2023-11-14T22:1")


@pytest.mark.parametrize(("way", "direction"), [("forward", 1), ("backward", -1)])
def test_a_profile_is_by_default_every_bin_at_its_centre(
    book: SlopeBook, profile: RoadProfile, way: str, direction: int
) -> None:
    answer = asked(book, path_of(profile), direction=way)
    assert (answer["road_id"], answer["direction"]) == (profile.road.road_id, way)
    assert len(answer["points"]) == profile.road.bins
    for index, point in enumerate(answer["points"]):
        known = profile.bins[direction].get(index)
        expected = {
            "distance_m": 20.0 * index + 10.0,
            "grade_pct": known and known.grade_pct,
            "grade_std_pct": known and known.grade_std_pct,
            "alt_m": known and known.alt_m,
            "runs": 1 if known else 0,
            "updated": known and rfc3339(known.updated_ns),
            **({"flagged_runs": known.flagged_runs} if known else {}),
        }
        assert point == rounded(expected)


def test_the_profile_is_forward_and_near_the_truth(book: SlopeBook, profile: RoadProfile) -> None:
    points = [at for at in asked(book, path_of(profile))["points"] if at["grade_pct"] is not None]
    truth_pct = true_grade_pct(np.array([at["distance_m"] for at in points]))
    errors_pct = np.array([at["grade_pct"] for at in points]) - truth_pct
    assert np.sqrt(np.mean(errors_pct**2)) < 1.0
    backward = asked(book, path_of(profile), direction="backward")["points"]
    known = [at for at in backward if at["grade_pct"] is not None]
    truth_pct = -true_grade_pct(np.array([at["distance_m"] for at in known]))
    errors_pct = np.array([at["grade_pct"] for at in known]) - truth_pct
    assert np.sqrt(np.mean(errors_pct**2)) < 1.0


def test_a_part_of_a_profile_has_the_points_asked_for(
    book: SlopeBook, profile: RoadProfile
) -> None:
    points = asked(book, path_of(profile), from_m=790, to_m=830, step_m=8)["points"]
    assert [at["distance_m"] for at in points] == [790.0, 798.0, 806.0, 814.0, 822.0, 830.0]
    bins = profile.bins[1]
    grades_pct = [bins[39].grade_pct] * 2 + [None] * 2 + [bins[41].grade_pct] * 2
    assert [at["grade_pct"] for at in points] == rounded({"grade_pct": grades_pct})["grade_pct"]
    assert [at["runs"] for at in points] == [1, 1, 0, 0, 1, 1]


def test_a_profile_ends_with_its_road(book: SlopeBook, profile: RoadProfile) -> None:
    length_m = profile.road.line.length_m
    points = asked(book, path_of(profile), from_m=length_m - 5.0, to_m=9e6, step_m=1)["points"]
    assert len(points) == 6
    assert asked(book, path_of(profile), from_m=length_m + 1.0)["points"] == []


@pytest.mark.parametrize("way", ["forward", "backward"])
def test_the_csv_has_a_row_a_known_bin_like_the_export(
    book: SlopeBook, profile: RoadProfile, way: str
) -> None:
    answer = client(book).get(path_of(profile, "profile.csv"), params={"direction": way})
    assert answer.headers["content-type"] == "text/csv; charset=utf-8"
    rows = list(csv.DictReader(io.StringIO(answer.text)))
    points = [at for at in asked(book, path_of(profile), direction=way)["points"] if at["runs"]]
    assert list(rows[0]) == [
        "road_id", "distance_m", "lat_deg", "lon_deg", "heading_deg", "grade_pct",
        "grade_std_pct", "alt_m", "runs", "updated", "flagged_runs",
    ]  # fmt: skip
    assert len(rows) == len(points)
    for row, at in zip(rows, points, strict=True):
        assert float(row["distance_m"]) == at["distance_m"]
        assert float(row["grade_pct"]) == pytest.approx(at["grade_pct"], abs=5e-4)
        assert float(row["grade_std_pct"]) == pytest.approx(at["grade_std_pct"], abs=5e-4)
        assert float(row["alt_m"]) == pytest.approx(at["alt_m"], abs=5e-3)
        assert (row["runs"], row["updated"]) == ("1", at["updated"])
    heading_deg = float(rows[0]["heading_deg"])
    assert (heading_deg < 180.0) == (way == "forward")


@pytest.mark.parametrize("way", ["forward", "backward"])
def test_the_geojson_is_the_road_in_pieces_that_join(
    book: SlopeBook, profile: RoadProfile, way: str
) -> None:
    path = path_of(profile, "profile.geojson")
    answer = client(book).get(path, params={"direction": way, "from_m": 1000})
    assert answer.headers["content-type"] == "application/geo+json"
    collection = answer.json()
    features = collection["features"]
    assert collection["type"] == "FeatureCollection"
    assert [one["properties"]["distance_m"] for one in features[:2]] == [1010.0, 1030.0]
    assert len(features) == profile.road.bins - 50
    pieces = [one["geometry"]["coordinates"] for one in features]
    first, last = (0, -1) if way == "forward" else (-1, 0)
    assert all(one[last] == two[first] for one, two in itertools.pairwise(pieces))
    line = profile.road.line
    end = [round(float(line.lons_deg[-1]), 7), round(float(line.lats_deg[-1]), 7)]
    assert pieces[-1][last] == end
    joined = pieces if way == "forward" else pieces[::-1]
    whole = Line(*np.array([[lat, lon] for piece in joined for lon, lat in piece]).T)
    assert whole.length_m == pytest.approx(line.length_m - 1000.0, abs=0.1)


def test_what_is_learned_is_answered_from_then_on(profile: RoadProfile) -> None:
    book = SlopeBook(clock_ns=lambda: NOW_NS)
    assert asked(book, "/v1/roads") == {"roads": []}
    road = Road("route/1", 20.0, loop=False, is_route=True, points=profile.road.points)
    book.learn(RoadProfile(road, {}))
    assert asked(book, "/v1/roads")["roads"][0]["directions"] == []
    book.learn(RoadProfile(road, profile.bins))
    href = asked(book, "/v1/roads")["roads"][0]["href"]
    assert href == "/v1/roads/route%2F1/profile"
    grade_pct = profile.bins[1][50].grade_pct
    assert asked(book, href)["points"][50]["grade_pct"] == pytest.approx(grade_pct, abs=5e-4)
    lat_deg, lon_deg, heading_deg = profile.road.line.point_at(1500.0)
    place = {"lat_deg": lat_deg, "lon_deg": lon_deg, "heading_deg": heading_deg}
    assert asked(book, "/v1/lookahead", **place)["road_id"] == "route/1"


@pytest.mark.parametrize(
    ("query", "name"),
    [
        ("from_m=-1", "from_m"),
        ("from_m=inf", "from_m"),
        ("from_m=100&to_m=99", "to_m"),
        ("step_m=0", "step_m"),
        ("direction=sideways", "direction"),
    ],
)
def test_an_unfit_stretch_is_refused(
    book: SlopeBook, profile: RoadProfile, query: str, name: str
) -> None:
    answer = client(book).get(f"{path_of(profile)}?{query}")
    assert answer.status_code == 422
    assert answer.json()["invalid"][0]["name"] == name


def test_a_profile_of_too_many_points_is_refused() -> None:
    points = ((0.0, 0.0), (0.0, 1.0))
    road = Road("equator", 20.0, loop=False, is_route=False, points=points)
    book = SlopeBook([RoadProfile(road, {})], lambda: NOW_NS)
    answer = client(book).get("/v1/roads/equator/profile?step_m=1")
    assert answer.status_code == 422
    assert f"more than {POINTS_MAX}; ask for parts" in answer.json()["detail"]
    assert len(asked(book, "/v1/roads/equator/profile", step_m=1, to_m=200)["points"]) == 191


@pytest.mark.parametrize(
    ("path", "detail"),
    [
        ("/v1/roads/a/profile", "no road a; /v1/roads lists them"),
        ("/v1/roads/a%2Fb/profile.csv", "no road a/b; /v1/roads lists them"),
        ("/v1/roads/a/profile.geojson", "no road a; /v1/roads lists them"),
        ("/v1/vehicles/car/lookahead", "no vehicle car was heard"),
    ],
)
def test_what_is_not_known_is_a_problem(book: SlopeBook, path: str, detail: str) -> None:
    answer = client(book).get(path)
    assert answer.headers["content-type"] == "application/problem+json"
    assert (answer.status_code, answer.json()["detail"]) == (404, detail)


def test_with_tokens_nothing_is_told_without_one(book: SlopeBook) -> None:
    http = client(book, HttpSettings(tokens=(TOKEN,)))
    assert http.get("/v1/roads").status_code == 401
    assert http.get("/v1/roads", headers={"authorization": f"Bearer {TOKEN}"}).status_code == 200
    with pytest.raises(InputError, match="without tokens"):
        client(book, HttpSettings(host="0.0.0.0"))


def test_openapi_describes_parameters_and_answers(book: SlopeBook) -> None:
    document = client(book).get("/openapi.json").json()
    operation = document["paths"]["/v1/lookahead"]["get"]
    parameters = {one["name"]: one for one in operation["parameters"]}
    required = [name for name, one in parameters.items() if one["required"]]
    assert required == ["lat_deg", "lon_deg", "heading_deg"]
    step = parameters["step_m"]["schema"]
    assert (step["minimum"], step["maximum"], step["default"]) == (1.0, 1000.0, 20.0)
    schema = operation["responses"]["200"]["content"]["application/json"]["schema"]
    assert schema == {"$ref": "#/components/schemas/LookaheadAnswer"}
    fields = document["components"]["schemas"]["SlopePoint"]["properties"]
    told = ["distance_m", "grade_pct", "grade_std_pct", "alt_m", "runs", "updated", "flagged_runs"]
    assert list(fields) == told
    stretch = document["paths"]["/v1/roads/{road_id}/profile.csv"]["get"]["parameters"]
    assert [one["name"] for one in stretch] == ["road_id", "direction", "from_m", "to_m"]
