"""The road ahead over HTTP: the core's own points, and a vehicle's beside its horizon."""

import msgspec
import pytest

from unit.slope_map.asking import NOW_NS, asked, client, profile_of, shown
from unit.slope_map.hilly_road import (
    SECOND_NS,
    START_NS,
    core,
    drive,
    ring,
    runs_of,
)
from wayline.digits import rounded
from wayline.messages import Gyro, Horizon, Message, Pose
from wayline.query_error import QueryError
from wayline.view import Receipt
from wayline_slope_map.book import SlopeBook
from wayline_slope_map.known_roads import KnownRoads
from wayline_slope_map.matching import RoadIndex
from wayline_slope_map.profile import RoadProfile, lookahead
from wayline_slope_map.queries import answer_lookahead


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
    assert rounded(answer) == asked(book, "/v1/lookahead", **place, length_m=100)
    with pytest.raises(QueryError, match=r"step_m: Expected `float` >= 1\.0") as refused:
        answer_lookahead(book, {**place, "step_m": "0.5"})
    assert (refused.value.status, refused.value.parameter) == (422, "step_m")


HEARD = Receipt(NOW_NS)


def heard(book: SlopeBook, profile: RoadProfile, *, backwards: bool = False) -> Horizon:
    """Drive 60 s over the known road; the last horizon that was made on a whole second."""
    knowing, last = core(profiles=[profile]), None
    later_ns = START_NS + 86_400 * SECOND_NS
    for message in drive(seed=9, length_m=900.0, start_ns=later_ns, backwards=backwards):
        for output in [message, *knowing.handle(message, "test")]:
            if isinstance(output, Pose | Horizon):
                book.put("car", output, "test", HEARD)
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
    assert answer["road_id"] == horizon.road_id
    assert answer["position_m"] == pytest.approx(horizon.position_m, abs=0.005)
    assert answer["points"] == [shown(point) for point in horizon.points]
    assert any(at["grade_pct"] is not None for at in answer["points"])


def test_between_horizons_a_vehicle_is_carried_on(book: SlopeBook, profile: RoadProfile) -> None:
    horizon = heard(book, profile)
    pose = Pose(t_ns=horizon.t_ns, mode="fused", distance_m=750.0 + 12.0)
    book.put("car", pose, "fusion", HEARD)
    answer = asked(book, "/v1/vehicles/car/lookahead", length_m=100, step_m=50)
    assert horizon.position_m is not None
    assert answer["position_m"] == pytest.approx(horizon.position_m + 12.0, abs=0.005)
    assert [at["distance_m"] for at in answer["points"]] == [0.0, 50.0, 100.0]
    restarted = msgspec.structs.replace(pose, distance_m=0.0)
    book.put("car", restarted, "fusion", HEARD)
    position_m = asked(book, "/v1/vehicles/car/lookahead")["position_m"]
    assert position_m == pytest.approx(horizon.position_m, abs=0.005)


def test_a_vehicle_is_carried_to_the_end_of_its_road_and_no_further(
    book: SlopeBook, profile: RoadProfile
) -> None:
    horizon = heard(book, profile)
    book.put("car", Pose(t_ns=horizon.t_ns, mode="fused", distance_m=9e4), "fusion", HEARD)
    answer = asked(book, "/v1/vehicles/car/lookahead")
    assert answer["position_m"] == pytest.approx(profile.road.line.length_m, abs=0.005)


def test_a_vehicle_goes_the_way_that_its_horizon_says(
    book: SlopeBook, profile: RoadProfile
) -> None:
    """The core has decided, in reverse too: the pose is not asked again."""
    lat_deg, lon_deg, heading_deg = profile.road.line.point_at(500.0)
    pose = Pose(
        t_ns=START_NS, mode="fused", lat_deg=lat_deg, lon_deg=lon_deg, heading_deg=heading_deg
    )
    book.put("car", pose, "fusion", HEARD)
    road_id = profile.road.road_id
    horizon = Horizon(t_ns=START_NS, road_id=road_id, direction=-1, position_m=500.0)
    book.put("car", horizon, "slope-map", HEARD)
    assert asked(book, "/v1/vehicles/car/lookahead")["direction"] == "backward"


def test_a_vehicle_on_no_road_has_null_and_its_age(profile: RoadProfile) -> None:
    now_ns = [NOW_NS]
    book = SlopeBook([profile], lambda: now_ns[0])
    book.put("car", Pose(t_ns=START_NS, mode="starting"), "fusion", HEARD)
    now_ns[0] += 1500 * SECOND_NS // 1000
    for message in (Horizon(t_ns=START_NS), Gyro(t_ns=START_NS, yaw_rate_degps=1.0)):
        unknown: Message = message
        book.put("car", unknown, "x", HEARD)
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
    book.put("car", pose, "fusion", HEARD)
    horizon = Horizon(
        t_ns=START_NS, road_id=profile.road.road_id, direction=1, position_m=length_m - 30.0
    )
    book.put("car", horizon, "slope-map", HEARD)
    book.put("car", msgspec.structs.replace(pose, distance_m=60.0), "fusion", HEARD)
    answer = asked(book, "/v1/vehicles/car/lookahead")
    assert answer["position_m"] == pytest.approx(20.0, abs=1e-6)


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


def test_a_road_that_only_cores_know_yet_is_no_road_ahead(profile: RoadProfile) -> None:
    """They share an index with the book; what is to be kept first is told later."""
    index = RoadIndex()
    roads, book = KnownRoads(index=index), SlopeBook(index=index)
    roads.learn(RoadProfile(profile.road, {}))
    place = profile.road.line.point_at(1_000.0)
    assert book.nearest(*place) is None
    book.learn(profile)
    found = book.nearest(*place)
    assert found is not None
    assert found[0] is profile
    assert found[1].along_m == pytest.approx(1_000.0, abs=1.0)
