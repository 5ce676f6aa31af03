"""Eta's answers: the numbers of the core's own messages, their ages, and what is refused."""

from typing import Any

import msgspec
import pytest
from fastapi.testclient import TestClient

from unit.eta.route_drives import SECOND_NS, SQUARE, START_NS, Told, follow, poses, route_of
from wayline.errors import InputError
from wayline.http_settings import HttpSettings
from wayline.messages import Arrivals, GpsFix, Health, Message, Pose, Progress, StopArrival
from wayline.query_error import QueryError
from wayline.rfc3339 import rfc3339
from wayline.tuning import Tuning
from wayline.view import Receipt
from wayline_eta.app import create_eta_app
from wayline_eta.board import EtaBoard, answer_arrivals
from wayline_eta.core import EtaCore

ROUTE = route_of(SQUARE, route_id="north/south", stops_m=[300.0, 900.0, 1500.0], dwell_s=20.0)
TOKEN = "correct-horse-battery"


class Clock:
    """A clock that is moved by hand, as far from the messages' own time as can be."""

    def __init__(self) -> None:
        self.now_ns = 5 * SECOND_NS

    def __call__(self) -> int:
        return self.now_ns

    def wait(self, seconds: float) -> None:
        self.now_ns += round(seconds * SECOND_NS)


class Board(EtaBoard):
    """A board that is told of each message as it comes."""

    def __init__(self, clock: Clock) -> None:
        super().__init__(clock)
        self._clock = clock

    def hear(self, vehicle_id: str, message: Message, source: str, age_s: float = 0.0) -> None:
        self.put(vehicle_id, message, source, Receipt(self._clock(), round(age_s * 1e9)))


@pytest.fixture(scope="module")
def told() -> Told:
    """What the core says after 20 s along the square."""
    return follow(EtaCore([ROUTE], Tuning()), poses(SQUARE, [10.0] * 21))[-1]


@pytest.fixture
def clock() -> Clock:
    return Clock()


@pytest.fixture
def board(clock: Clock, told: Told) -> Board:
    board = Board(clock)
    put_drive(board, "bus-1", told)
    return board


def put_drive(board: Board, vehicle_id: str, told: Told) -> None:
    board.hear(vehicle_id, last_pose(), "fusion")
    board.hear(vehicle_id, told.progress, "eta")
    board.hear(vehicle_id, told.arrivals, "eta")


def last_pose() -> Pose:
    return poses(SQUARE, [10.0] * 21)[-1][0]


def client(board: Board, settings: HttpSettings | None = None) -> TestClient:
    app = create_eta_app(board, [ROUTE], settings or HttpSettings())
    return TestClient(app, base_url="http://localhost")


def arrivals_of(board: Board, path: str = "/v1/vehicles/bus-1/arrivals") -> list[dict[str, Any]]:
    answer = client(board).get(path)
    assert answer.status_code == 200, answer.text
    found: list[dict[str, Any]] = answer.json()["arrivals"]
    return found


def test_arrivals_are_the_cores_own_numbers(board: Board, told: Told) -> None:
    found = arrivals_of(board)
    assert len(found) == 3
    for at, stop in zip(found, told.arrivals.stops, strict=True):
        assert at == {
            "stop_id": stop.stop_id,
            "name": stop.name,
            "vehicle_id": "bus-1",
            "route_id": "north/south",
            "trip_id": None,
            "headsign": None,
            "distance_m": pytest.approx(stop.distance_m, abs=0.005),
            "arrival": rfc3339(stop.arrival_ns),
            "early": rfc3339(stop.early_ns),
            "late": rfc3339(stop.late_ns),
            "departure": None,
            "scheduled": None,
            "delay_s": None,
            "confidence": "planned",
            "seconds": pytest.approx((stop.arrival_ns - told.arrivals.t_ns) * 1e-9, abs=5e-3),
            "age_s": 0.0,
            "stale": False,
        }
    assert found[0]["seconds"] == pytest.approx(10.0, abs=1.0)
    assert found[0]["arrival"].startswith("2023-11-14T22:13:5")


def test_seconds_count_down_and_ages_up_by_the_readers_clock(board: Board, clock: Clock) -> None:
    before = arrivals_of(board)
    clock.wait(2.5)
    after = arrivals_of(board)
    gone_s = [one["seconds"] - two["seconds"] for one, two in zip(before, after, strict=True)]
    assert gone_s == [pytest.approx(2.5)] * 3
    assert [at["age_s"] for at in after] == [2.5] * 3
    assert [at["arrival"] for at in after] == [at["arrival"] for at in before]
    clock.wait(20.0)
    assert arrivals_of(board)[0]["seconds"] == 0.0


def test_the_age_is_that_of_the_position_that_arrivals_rest_on(
    board: Board, clock: Clock, told: Told
) -> None:
    """Predictions from a position 8 s old are not fresh because they were just made."""
    clock.wait(8.0)
    board.hear("bus-1", later(told.arrivals, 8.0, stale=True), "eta")
    at = arrivals_of(board)[0]
    assert (at["age_s"], at["stale"]) == (8.0, True)
    assert at["seconds"] == pytest.approx(2.0, abs=1.0)


def later(arrivals: Arrivals, seconds: float, *, stale: bool) -> Arrivals:
    t_ns = arrivals.t_ns + round(seconds * SECOND_NS)
    return msgspec.structs.replace(arrivals, t_ns=t_ns, stale=stale)


def test_the_age_counts_from_what_the_vehicle_says_where_that_is_older(
    board: Board, told: Told
) -> None:
    board.hear("bus-1", told.arrivals, "eta", age_s=3600.0)
    board.hear("bus-1", last_pose(), "fusion", age_s=3600.0)
    assert {at["age_s"] for at in arrivals_of(board)} == {3600.0}
    assert client(board).get("/v1/vehicles/bus-1").json()["age_s"] == 3600.0


def test_a_forgotten_vehicle_is_not_known(board: Board) -> None:
    board.forget("bus-1")
    assert board.vehicle_ids() == []
    assert client(board).get("/v1/vehicles/bus-1").status_code == 404


def test_a_stops_arrivals_are_of_all_vehicles_soonest_first(
    board: Board, clock: Clock, told: Told
) -> None:
    """bus-0 is a recording of another day, 300 s of planned time further away."""
    other = told.arrivals
    day_ns = 86_400 * SECOND_NS
    stops = [
        StopArrival(
            stop_id=stop.stop_id,
            name=stop.name,
            distance_m=stop.distance_m + 3000.0,
            arrival_ns=stop.arrival_ns + 300 * SECOND_NS - day_ns,
            early_ns=stop.early_ns + 300 * SECOND_NS - day_ns,
            late_ns=stop.late_ns + 300 * SECOND_NS - day_ns,
        )
        for stop in other.stops
    ]
    board.hear(
        "bus-0",
        Arrivals(t_ns=other.t_ns - day_ns, route_id="other", stale=False, stops=tuple(stops)),
        "eta",
    )
    found = arrivals_of(board, "/v1/stops/s1/arrivals")
    assert [(at["vehicle_id"], at["stop_id"]) for at in found] == [("bus-1", "s1"), ("bus-0", "s1")]
    assert found[1]["seconds"] - found[0]["seconds"] == pytest.approx(300.0)


def test_one_stop_of_one_vehicle_can_be_asked_for(board: Board) -> None:
    [at] = arrivals_of(board, "/v1/vehicles/bus-1/arrivals?stop_id=s2")
    assert at == arrivals_of(board)[2]


def test_a_query_gets_what_http_gets(board: Board) -> None:
    whole = answer_arrivals(board, "bus-1")
    assert [at.stop_id for at in whole.arrivals] == ["s0", "s1", "s2"]
    part = answer_arrivals(board, "bus-1", {"stop_id": "s1"})
    assert part.arrivals == whole.arrivals[1:2]
    with pytest.raises(QueryError, match="no vehicle bus-9") as refused:
        answer_arrivals(board, "bus-9")
    assert refused.value.status == 404


def test_a_vehicle_has_position_progress_and_age(board: Board, clock: Clock, told: Told) -> None:
    clock.wait(1.25)
    vehicle = client(board).get("/v1/vehicles/bus-1").json()
    pose, progress = last_pose(), told.progress
    assert (vehicle["vehicle_id"], vehicle["age_s"], vehicle["on_route"]) == ("bus-1", 1.25, True)
    assert vehicle["position"] == {
        "t": "2023-11-14T22:13:40.000Z",
        "source": "fusion",
        "mode": "fused",
        "lat_deg": pytest.approx(pose.lat_deg, abs=1e-7),
        "lon_deg": pytest.approx(pose.lon_deg, abs=1e-7),
        "alt_m": None,
        "heading_deg": pytest.approx(pose.heading_deg, abs=0.005),
        "speed_mps": 10.0,
        "east_std_m": 0.5,
        "north_std_m": 0.5,
    }
    assert vehicle["progress"] == {
        "t": "2023-11-14T22:13:40.000Z",
        "route_id": "north/south",
        "trip_id": None,
        "distance_m": pytest.approx(progress.distance_m, abs=0.005),
        "lap": 0,
        "lat_deg": pytest.approx(progress.lat_deg, abs=1e-7),
        "lon_deg": pytest.approx(progress.lon_deg, abs=1e-7),
        "cross_track_m": pytest.approx(progress.cross_track_m, abs=0.005),
        "distance_std_m": pytest.approx(progress.distance_std_m, abs=0.005),
        "speed_mps": pytest.approx(progress.speed_mps, abs=0.005),
        "delay_s": None,
    }
    assert client(board).get("/v1/vehicles").json() == {"vehicles": [vehicle]}


def test_a_detour_is_said(board: Board) -> None:
    astray = Progress(
        t_ns=START_NS,
        route_id="r",
        distance_m=1.0,
        lat_deg=1.0,
        lon_deg=1.0,
        cross_track_m=500.0,
        distance_std_m=5.0,
        on_route=False,
        speed_mps=3.0,
    )
    board.hear("bus-1", astray, "eta")
    board.hear("bus-1", Arrivals(t_ns=START_NS, route_id="r", stale=False), "eta")
    assert client(board).get("/v1/vehicles/bus-1").json()["on_route"] is False
    assert arrivals_of(board) == []


def test_a_vehicle_of_which_little_is_known_has_nulls(board: Board) -> None:
    board.hear("bus-2", Arrivals(t_ns=START_NS, route_id="r", stale=False), "eta")
    vehicle = client(board).get("/v1/vehicles/bus-2").json()
    assert vehicle == {
        "vehicle_id": "bus-2",
        "age_s": None,
        "on_route": None,
        "position": None,
        "progress": None,
    }


@pytest.mark.parametrize(
    "message",
    [
        Pose(t_ns=START_NS, mode="starting"),
        Pose(t_ns=START_NS, mode="lost", lat_deg=1.0, lon_deg=1.0),
        GpsFix(t_ns=START_NS, valid=False),
        Health(t_ns=START_NS, service="eta", version="1", started_ns=0),
    ],
    ids=["starting", "lost", "invalid", "health"],
)
def test_what_has_no_position_is_no_position(board: Board, clock: Clock, message: Message) -> None:
    """Nor does it make a vehicle known."""
    clock.wait(1.0)
    board.hear("bus-1", message, "x")
    board.hear("bus-3", message, "x")
    assert client(board).get("/v1/vehicles/bus-1").json()["age_s"] == 1.0
    assert board.vehicle_ids() == ["bus-1"]


def test_a_fix_stands_in_while_fusion_is_silent(board: Board, clock: Clock) -> None:
    fix = GpsFix(
        t_ns=START_NS, valid=True, lat_deg=40.0, lon_deg=-75.0, course_deg=12.0, speed_mps=4.0
    )
    http = client(board)
    clock.wait(0.1)
    board.hear("bus-1", fix, "gps-ingest")
    assert http.get("/v1/vehicles/bus-1").json()["position"]["source"] == "fusion"
    board.hear("bus-1", last_pose(), "fusion")
    clock.wait(2.1)
    assert http.get("/v1/vehicles/bus-1").json()["position"]["source"] == "fusion"
    board.hear("bus-1", fix, "gps-ingest")
    vehicle = http.get("/v1/vehicles/bus-1").json()
    assert (vehicle["age_s"], vehicle["position"]["source"]) == (0.0, "gps-ingest")
    position = vehicle["position"]
    assert (position["lat_deg"], position["heading_deg"], position["mode"]) == (40.0, 12.0, None)


def test_a_route_is_listed_and_answered_as_geojson(board: Board) -> None:
    http = client(board)
    [summary] = http.get("/v1/routes").json()["routes"]
    assert (summary["stops"], summary["loop"]) == (3, True)
    assert summary["length_m"] == pytest.approx(ROUTE.length_m, abs=0.005)
    assert summary["href"] == "/v1/routes/north%2Fsouth"
    route = http.get(summary["href"])
    assert route.headers["content-type"] == "application/geo+json"
    features = route.json()["features"]
    assert [feature["geometry"]["type"] for feature in features] == ["LineString"] + 3 * ["Point"]
    assert features[0]["geometry"]["coordinates"][0] == [
        float(ROUTE.line.lons_deg[0]),
        float(ROUTE.line.lats_deg[0]),
    ]


@pytest.mark.parametrize(
    ("path", "detail"),
    [
        ("/v1/vehicles/bus-9", "no vehicle bus-9 was heard; /v1/vehicles lists them"),
        ("/v1/vehicles/bus-9/arrivals", "no vehicle bus-9 was heard; /v1/vehicles lists them"),
        ("/v1/routes/a%2Fb", "no route a/b; /v1/routes lists them"),
        ("/v1/stops/s9/arrivals", "no route has a stop s9; /v1/stops lists them"),
    ],
)
def test_what_is_not_known_is_a_problem(board: Board, path: str, detail: str) -> None:
    answer = client(board).get(path)
    assert answer.headers["content-type"] == "application/problem+json"
    assert answer.json() == {
        "type": "about:blank",
        "title": "Not Found",
        "status": 404,
        "detail": detail,
        "instance": path.replace("%2F", "/"),
    }


def test_with_tokens_nothing_is_told_without_one(board: Board) -> None:
    http = client(board, HttpSettings(tokens=(TOKEN,)))
    path = "/v1/vehicles/bus-1/arrivals"
    assert http.get(path).status_code == 401
    assert http.get(path, headers={"authorization": f"Bearer {TOKEN}"}).status_code == 200
    with pytest.raises(InputError, match="without tokens"):
        client(board, HttpSettings(host="0.0.0.0"))


def test_openapi_describes_paths_parameters_and_answers(board: Board) -> None:
    document = client(board).get("/openapi.json").json()
    operation = document["paths"]["/v1/vehicles/{vehicle_id}/arrivals"]["get"]
    named = [(one["name"], one["in"], one["required"]) for one in operation["parameters"]]
    assert named == [("vehicle_id", "path", True), ("stop_id", "query", False)]
    schema = operation["responses"]["200"]["content"]["application/json"]["schema"]
    assert schema == {"$ref": "#/components/schemas/ArrivalList"}
    fields = document["components"]["schemas"]["ArrivalAnswer"]["properties"]
    assert list(fields) == [
        "stop_id", "name", "vehicle_id", "route_id", "trip_id", "headsign", "distance_m", "arrival",
        "early", "late", "departure", "scheduled", "delay_s", "confidence", "seconds", "age_s",
        "stale",
    ]  # fmt: skip


def test_a_trip_s_arrivals_tell_where_it_goes_and_how_late_it_is(board: Board, told: Told) -> None:
    """Of a later trip of the block the present headsign says nothing."""
    first, second, *_ = told.arrivals.stops
    timed = [
        msgspec.structs.replace(
            stop,
            scheduled_ns=stop.arrival_ns - 90 * SECOND_NS,
            departure_ns=stop.arrival_ns + 20 * SECOND_NS,
            confidence="timetable",
            trip_id=trip_id,
        )
        for stop, trip_id in ((first, None), (second, "later"))
    ]
    arrivals = msgspec.structs.replace(
        told.arrivals, trip_id="now", headsign="Harbour", stops=tuple(timed)
    )
    board.hear("bus-1", arrivals, "eta")
    now, later = arrivals_of(board)
    assert (now["trip_id"], now["headsign"], now["delay_s"]) == ("now", "Harbour", 90.0)
    assert now["scheduled"] == rfc3339(first.arrival_ns - 90 * SECOND_NS)
    assert now["departure"] == rfc3339(first.arrival_ns + 20 * SECOND_NS)
    assert (later["trip_id"], later["headsign"]) == ("later", None)


def test_stops_are_listed_and_found_near_a_place(board: Board) -> None:
    http = client(board)
    assert [stop["stop_id"] for stop in http.get("/v1/stops").json()["stops"]] == ["s0", "s1", "s2"]
    stop = ROUTE.stops[1]
    near = f"{stop.lat_deg:.6f},{stop.lon_deg:.6f}"
    [found] = http.get("/v1/stops", params={"near": near, "radius_m": 50}).json()["stops"]
    assert (found["stop_id"], found["distance_m"]) == ("s1", pytest.approx(0.0, abs=0.2))
    wide = http.get("/v1/stops", params={"near": near, "radius_m": 5000, "limit": 2}).json()
    assert len(wide["stops"]) == 2
    assert wide["stops"][0]["stop_id"] == "s1"


@pytest.mark.parametrize(
    "wrong", [{"near": "here"}, {"near": "91,0"}, {"near": "1,2", "radius_m": 0}, {"limit": 0}]
)
def test_a_place_that_is_none_is_refused(board: Board, wrong: dict[str, str]) -> None:
    assert client(board).get("/v1/stops", params=wrong).status_code == 422


def test_a_stop_s_arrivals_can_be_asked_for_by_route_minutes_and_number(
    board: Board, told: Told
) -> None:
    """Of two vehicles of two routes, ten seconds and five minutes away."""
    later = [
        msgspec.structs.replace(stop, arrival_ns=stop.arrival_ns + 300 * SECOND_NS)
        for stop in told.arrivals.stops
    ]
    other = msgspec.structs.replace(told.arrivals, route_id="other", stops=tuple(later))
    board.hear("bus-2", other, "eta")

    def vehicles(**asked: str | float) -> list[str]:
        found = client(board).get("/v1/stops/s0/arrivals", params=asked).json()["arrivals"]
        return [at["vehicle_id"] for at in found]

    assert vehicles() == ["bus-1", "bus-2"]
    assert vehicles(route_id="other") == ["bus-2"]
    assert vehicles(minutes=2) == vehicles(limit=1) == ["bus-1"]
    assert client(board).get("/v1/stops/s0/arrivals?minutes=0").status_code == 422
