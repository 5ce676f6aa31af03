"""The slope map's answers: the core's own numbers, unknown as null, and what is refused."""

import csv
import io
import itertools
from typing import Any

import msgspec
import numpy as np
import pytest
from fastapi.testclient import TestClient

from unit.slope_map.hilly_road import (
    SECOND_NS,
    START_NS,
    core,
    drive,
    ring,
    runs_of,
    true_grade_pct,
)
from wayline.errors import InputError
from wayline.http_settings import HttpSettings
from wayline.line import Line
from wayline.messages import Gyro, Horizon, HorizonPoint, Message, Pose
from wayline.query_error import QueryError
from wayline.rfc3339 import rfc3339
from wayline_slope_map.app import create_slope_app
from wayline_slope_map.book import SlopeBook
from wayline_slope_map.profile import RoadProfile, lookahead
from wayline_slope_map.queries import answer_lookahead
from wayline_slope_map.questions import POINTS_MAX
from wayline_slope_map.records import FinishedRun
from wayline_slope_map.roads import Road
from wayline_slope_map.sums import BinEstimate, estimate, run_sums

TOKEN = "correct-horse-battery"
NOW_NS = 7 * SECOND_NS


def profile_of(*runs: FinishedRun) -> RoadProfile:
    bins: dict[int, dict[int, BinEstimate]] = {
        run.direction: {
            at.bin_index: estimate(
                run_sums(at.grade_pct, at.grade_std_pct, at.alt_m, at.alt_std_m, run.end_ns)
            )
            for at in run.bins
            if at.sensor == "fused"
        }
        for run in runs
    }
    return RoadProfile(runs[0].road, bins)


@pytest.fixture(scope="module")
def profile() -> RoadProfile:
    """A road of 3 km, driven once each way; one of its bins is not known forward."""
    (there,) = runs_of(core(), drive(seed=1, length_m=3000.0))
    knowing = core(profiles=[profile_of(there)])
    later_ns = START_NS + 3600 * SECOND_NS
    back_drive = drive(seed=2, length_m=3000.0, backwards=True, start_ns=later_ns)
    (back,) = runs_of(knowing, back_drive)
    both = profile_of(there, back)
    forward = {index: known for index, known in both.bins[1].items() if index != 40}
    return RoadProfile(both.road, {1: forward, -1: both.bins[-1]})


@pytest.fixture
def book(profile: RoadProfile) -> SlopeBook:
    return SlopeBook([profile], lambda: NOW_NS)


def client(book: SlopeBook, settings: HttpSettings | None = None) -> TestClient:
    return TestClient(
        create_slope_app(book, settings or HttpSettings()), base_url="http://localhost"
    )


def asked(book: SlopeBook, path: str, **parameters: float | str) -> Any:
    answer = client(book).get(path, params=parameters)
    assert answer.status_code == 200, answer.text
    return answer.json()


def path_of(profile: RoadProfile, document: str = "profile") -> str:
    return f"/v1/roads/{profile.road.road_id}/{document}"


def shown(point: HorizonPoint) -> dict[str, Any]:
    """A point of the core as HTTP shows it."""
    fields = msgspec.structs.asdict(point)
    updated_ns = fields.pop("updated_ns")
    return {**fields, "updated": None if updated_ns is None else rfc3339(updated_ns)}


def test_roads_are_listed_with_what_is_known_of_them(book: SlopeBook, profile: RoadProfile) -> None:
    [road] = asked(book, "/v1/roads")["roads"]
    assert road == {
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
        assert point == {
            "distance_m": 20.0 * index + 10.0,
            "grade_pct": known and known.grade_pct,
            "grade_std_pct": known and known.grade_std_pct,
            "alt_m": known and known.alt_m,
            "runs": 1 if known else 0,
            "updated": known and rfc3339(known.updated_ns),
        }


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
    assert [at["grade_pct"] for at in points] == grades_pct
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
        "grade_std_pct", "alt_m", "runs", "updated",
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


@pytest.mark.parametrize(
    ("turn_deg", "way", "direction"), [(0, "forward", 1), (180, "backward", -1)]
)
def test_the_lookahead_of_a_place_is_the_cores(
    book: SlopeBook, profile: RoadProfile, turn_deg: float, way: str, direction: int
) -> None:
    lat_deg, lon_deg, heading_deg = profile.road.line.point_at(1500.0)
    parameters = {
        "lat_deg": lat_deg,
        "lon_deg": lon_deg,
        "heading_deg": (heading_deg + turn_deg) % 360.0,
    }
    answer = asked(book, "/v1/lookahead", **parameters)
    assert (answer["road_id"], answer["direction"]) == (profile.road.road_id, way)
    at_m = answer["position_m"]
    assert at_m == pytest.approx(1500.0, abs=0.5)
    expected = lookahead(profile, at_m, direction, length_m=2000.0, step_m=20.0)
    assert answer["points"] == [shown(point) for point in expected]
    assert len(answer["points"]) == 101
    # the road's end (or start) is about 1500 m away; beyond it nothing is known
    assert {at["grade_pct"] for at in answer["points"][78:]} == {None}
    finer = asked(book, "/v1/lookahead", **parameters, length_m=10, step_m=2.5)
    assert [at["distance_m"] for at in finer["points"]] == [0.0, 2.5, 5.0, 7.5, 10.0]


def test_off_every_road_all_is_null_and_not_0(book: SlopeBook, profile: RoadProfile) -> None:
    lat_deg, lon_deg, heading_deg = profile.road.line.point_at(1500.0)
    for place in (
        {"lat_deg": lat_deg + 0.01, "lon_deg": lon_deg, "heading_deg": heading_deg},
        {"lat_deg": lat_deg, "lon_deg": lon_deg, "heading_deg": (heading_deg + 90.0) % 360.0},
    ):
        answer = asked(book, "/v1/lookahead", **place, length_m=40)
        nothing = {
            "grade_pct": None, "grade_std_pct": None, "alt_m": None, "runs": 0, "updated": None
        }  # fmt: skip
        assert answer == {
            "road_id": None,
            "position_m": None,
            "direction": None,
            "points": [{"distance_m": at_m, **nothing} for at_m in (0.0, 20.0, 40.0)],
        }


def test_a_query_gets_what_http_gets(book: SlopeBook, profile: RoadProfile) -> None:
    lat_deg, lon_deg, heading_deg = profile.road.line.point_at(1500.0)
    place = {"lat_deg": f"{lat_deg}", "lon_deg": f"{lon_deg}", "heading_deg": f"{heading_deg}"}
    answer = answer_lookahead(book, {**place, "length_m": "100"})
    assert msgspec.json.decode(msgspec.json.encode(answer)) == asked(
        book, "/v1/lookahead", **place, length_m=100
    )
    with pytest.raises(QueryError, match=r"step_m: Expected `float` >= 1\.0") as refused:
        answer_lookahead(book, {**place, "step_m": "0.5"})
    assert (refused.value.status, refused.value.parameter) == (422, "step_m")


def heard(book: SlopeBook, profile: RoadProfile, *, backwards: bool = False) -> Horizon:
    """Drive 60 s over the known road; the last horizon that was made on a whole second."""
    knowing, last = core(profiles=[profile]), None
    later_ns = START_NS + 86_400 * SECOND_NS
    for message in drive(seed=9, length_m=900.0, start_ns=later_ns, backwards=backwards):
        for output in [message, *knowing.handle(message, "test")]:
            if isinstance(output, Pose | Horizon):
                book.put("car", output, "test")
                last = output if isinstance(output, Horizon) else last
                if isinstance(output, Horizon) and output.t_ns >= later_ns + 50 * SECOND_NS:
                    return output
    assert last is not None
    return last


@pytest.mark.parametrize("backwards", [False, True])
def test_a_vehicles_lookahead_is_its_horizon(
    book: SlopeBook, profile: RoadProfile, backwards: bool
) -> None:
    horizon = heard(book, profile, backwards=backwards)
    answer = asked(book, "/v1/vehicles/car/lookahead")
    assert answer["vehicle_id"] == "car"
    assert answer["direction"] == ("backward" if backwards else "forward")
    assert (answer["road_id"], answer["position_m"]) == (horizon.road_id, horizon.position_m)
    assert answer["points"] == [shown(point) for point in horizon.points]
    assert any(at["grade_pct"] is not None for at in answer["points"])


def test_between_horizons_a_vehicle_is_carried_on(book: SlopeBook, profile: RoadProfile) -> None:
    horizon = heard(book, profile)
    pose = Pose(t_ns=horizon.t_ns, mode="fused", distance_m=750.0 + 12.0)
    book.put("car", pose, "fusion")
    answer = asked(book, "/v1/vehicles/car/lookahead", length_m=100, step_m=50)
    assert horizon.position_m is not None
    assert answer["position_m"] == pytest.approx(horizon.position_m + 12.0, abs=1e-6)
    assert [at["distance_m"] for at in answer["points"]] == [0.0, 50.0, 100.0]
    restarted = msgspec.structs.replace(pose, distance_m=0.0)
    book.put("car", restarted, "fusion")
    assert asked(book, "/v1/vehicles/car/lookahead")["position_m"] == horizon.position_m


def test_a_vehicle_is_carried_to_the_end_of_its_road_and_no_further(
    book: SlopeBook, profile: RoadProfile
) -> None:
    horizon = heard(book, profile)
    book.put("car", Pose(t_ns=horizon.t_ns, mode="fused", distance_m=9e4), "fusion")
    answer = asked(book, "/v1/vehicles/car/lookahead")
    assert answer["position_m"] == profile.road.line.length_m


def test_a_vehicle_in_reverse_goes_tail_first(book: SlopeBook, profile: RoadProfile) -> None:
    lat_deg, lon_deg, heading_deg = profile.road.line.point_at(500.0)
    pose = Pose(
        t_ns=START_NS,
        mode="fused",
        lat_deg=lat_deg,
        lon_deg=lon_deg,
        heading_deg=heading_deg,
        speed_mps=-1.0,
    )
    book.put("car", pose, "fusion")
    horizon = Horizon(t_ns=START_NS, road_id=profile.road.road_id, position_m=500.0)
    book.put("car", horizon, "slope-map")
    assert asked(book, "/v1/vehicles/car/lookahead")["direction"] == "backward"


def test_a_vehicle_on_no_road_has_null_and_its_age(profile: RoadProfile) -> None:
    now_ns = [NOW_NS]
    book = SlopeBook([profile], lambda: now_ns[0])
    book.put("car", Pose(t_ns=START_NS, mode="starting"), "fusion")
    now_ns[0] += 1500 * SECOND_NS // 1000
    for message in (Horizon(t_ns=START_NS), Gyro(t_ns=START_NS, yaw_rate_degps=1.0)):
        unknown: Message = message
        book.put("car", unknown, "x")
        answer = asked(book, "/v1/vehicles/car/lookahead", length_m=20)
        assert (answer["road_id"], answer["age_s"]) == (None, 1.5)
        assert [at["grade_pct"] for at in answer["points"]] == [None, None]
    assert book.vehicle_ids() == ["car"]


def test_a_loop_goes_on_after_its_end() -> None:
    laps = drive(seed=6, length_m=1800.0, path=ring(1200.0), grade_of=lambda d: d)
    profile = profile_of(runs_of(core(), laps)[0])
    book = SlopeBook([profile], lambda: NOW_NS)
    length_m = profile.road.line.length_m
    lat_deg, lon_deg, heading_deg = profile.road.line.point_at(length_m - 30.0)
    pose = Pose(
        t_ns=START_NS,
        mode="fused",
        lat_deg=lat_deg,
        lon_deg=lon_deg,
        heading_deg=heading_deg,
        distance_m=10.0,
    )
    book.put("car", pose, "fusion")
    horizon = Horizon(t_ns=START_NS, road_id=profile.road.road_id, position_m=length_m - 30.0)
    book.put("car", horizon, "slope-map")
    book.put("car", msgspec.structs.replace(pose, distance_m=60.0), "fusion")
    answer = asked(book, "/v1/vehicles/car/lookahead")
    assert answer["position_m"] == pytest.approx(20.0, abs=1e-6)


def test_what_is_learned_is_answered_from_then_on(profile: RoadProfile) -> None:
    book = SlopeBook(clock_ns=lambda: NOW_NS)
    assert asked(book, "/v1/roads") == {"roads": []}
    road = Road("route/1", 20.0, loop=False, is_route=True, points=profile.road.points)
    book.learn(RoadProfile(road, {}))
    assert asked(book, "/v1/roads")["roads"][0]["directions"] == []
    book.learn(RoadProfile(road, profile.bins))
    href = asked(book, "/v1/roads")["roads"][0]["href"]
    assert href == "/v1/roads/route%2F1/profile"
    assert asked(book, href)["points"][50]["grade_pct"] == profile.bins[1][50].grade_pct
    lat_deg, lon_deg, heading_deg = profile.road.line.point_at(1500.0)
    place = {"lat_deg": lat_deg, "lon_deg": lon_deg, "heading_deg": heading_deg}
    assert asked(book, "/v1/lookahead", **place)["road_id"] == "route/1"


@pytest.mark.parametrize(
    ("parameters", "name"),
    [
        ({"step_m": "0.99"}, "step_m"),
        ({"step_m": "1000.1"}, "step_m"),
        ({"length_m": "0"}, "length_m"),
        ({"length_m": "20000.5"}, "length_m"),
        ({"length_m": "nan"}, "length_m"),
        ({"length_m": ""}, "length_m"),
        ({"heading_deg": "360"}, "heading_deg"),
        ({"lat_deg": "90.1"}, "lat_deg"),
        ({"lon_deg": "x"}, "lon_deg"),
        ({"lat_deg": None}, "lat_deg"),
    ],
)
def test_an_unfit_parameter_is_named(
    book: SlopeBook, parameters: dict[str, str | None], name: str
) -> None:
    fit = {"lat_deg": "55.9", "lon_deg": "9.8", "heading_deg": "90"}
    wrong = {key: value for key, value in {**fit, **parameters}.items() if value is not None}
    answer = client(book).get("/v1/lookahead", params=wrong)
    assert answer.headers["content-type"] == "application/problem+json"
    problem = answer.json()
    assert (answer.status_code, problem["status"]) == (422, 422)
    assert [one["name"] for one in problem["invalid"]] == [name]
    assert problem["detail"] == f"{name}: {problem['invalid'][0]['reason']}"


def test_the_limits_themselves_are_fit(book: SlopeBook) -> None:
    place = {"lat_deg": -90, "lon_deg": 180, "heading_deg": 0}
    assert len(asked(book, "/v1/lookahead", **place, length_m=20000, step_m=1)["points"]) == 20001
    assert len(asked(book, "/v1/lookahead", **place, length_m=20000, step_m=1000)["points"]) == 21


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
    assert list(fields) == ["distance_m", "grade_pct", "grade_std_pct", "alt_m", "runs", "updated"]
    stretch = document["paths"]["/v1/roads/{road_id}/profile.csv"]["get"]["parameters"]
    assert [one["name"] for one in stretch] == ["road_id", "direction", "from_m", "to_m"]
