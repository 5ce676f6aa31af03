"""Routes are read, checked, measured and written."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from wayline.errors import InputError
from wayline.geo import LocalPlane
from wayline.line import Line
from wayline.route import DEFAULT_SPEED_MPS, Route, make_route
from wayline.route_file import load_route, write_route
from wayline.stops import StopPlace, place_stops

DEMO_ROUTE = Path(__file__).parents[3] / "deploy" / "demo" / "avl-shuttle" / "route.geojson"
PLANE = LocalPlane(39.9, -75.35)
LOOP = [[-75.35, 39.9], [-75.345, 39.9], [-75.345, 39.905], [-75.35, 39.9]]


def feature(kind: str, coordinates: Any, **properties: Any) -> dict[str, Any]:
    return {
        "type": "Feature",
        "geometry": {"type": kind, "coordinates": coordinates},
        "properties": properties,
    }


def written(folder: Path, *features: dict[str, Any]) -> Path:
    path = folder / "route.geojson"
    path.write_text(json.dumps({"type": "FeatureCollection", "features": features}))
    return path


def loop_line(**changes: Any) -> dict[str, Any]:
    properties = {"route_id": "r", "name": "R", "loop": True, "speeds_mps": [10.0, 5.0, 20.0]}
    return feature("LineString", LOOP, **(properties | changes))


def stop(stop_id: str, lon_deg: float, lat_deg: float, **properties: Any) -> dict[str, Any]:
    return feature("Point", [lon_deg, lat_deg], stop_id=stop_id, **properties)


def test_a_loop_with_stops_is_read(tmp_path: Path) -> None:
    route = load_route(
        written(
            tmp_path,
            loop_line(),
            stop("a", -75.35, 39.9, name="Gate", dwell_s=20),
            stop("b", -75.345, 39.9025),
        )
    )
    assert (route.route_id, route.name, route.loop) == ("r", "R", True)
    assert route.speeds_mps.tolist() == [10.0, 5.0, 20.0]
    gate, second = route.stops
    assert (gate.name, gate.dwell_s, gate.distance_m) == ("Gate", 20.0, 0.0)
    assert (second.name, second.dwell_s) == ("b", 0.0)
    assert second.distance_m == pytest.approx(route.line.distances_m[1] + 277.6, abs=0.5)


def test_a_route_without_speeds_drives_at_the_default(tmp_path: Path) -> None:
    line = feature("LineString", LOOP[:3], route_id="r")
    route = load_route(written(tmp_path, line))
    assert route.speeds_mps.tolist() == [DEFAULT_SPEED_MPS, DEFAULT_SPEED_MPS]
    assert (route.name, route.loop) == ("r", False)


def test_a_leg_without_length_is_dropped_with_its_speed(tmp_path: Path) -> None:
    line = feature(
        "LineString", [LOOP[0], LOOP[0], LOOP[1], LOOP[2]], route_id="r", speeds_mps=[1, 2, 3]
    )
    route = load_route(written(tmp_path, line))
    assert route.speeds_mps.tolist() == [2.0, 3.0]
    assert route.line.legs_m.min() > 400.0


@pytest.mark.parametrize(
    ("features", "says"),
    [
        ([feature("LineString", LOOP[:1], route_id="r")], "1 point"),
        ([feature("LineString", [LOOP[0]] * 2, route_id="r")], "all points of the line are one"),
        ([loop_line(speeds_mps=[1.0, 2.0])], "2 speeds_mps for 3 legs"),
        ([loop_line(speeds_mps=[1.0, 0.0, 2.0])], "speed 0 of leg 2"),
        ([feature("LineString", LOOP[:3], route_id="r", loop=True)], "a loop that ends"),
        ([loop_line(), feature("Point", LOOP[0], name="x")], "stop 1: .*stop_id"),
        ([loop_line(), stop("far", -75.36, 39.9)], r"stop far is \d+ m from the line"),
        ([loop_line(), stop("q", -75.36, 99.0)], "latitude 99"),
        ([loop_line(name=3)], "Expected `str.*name"),
        ([feature("LineString", LOOP)], "route_id"),
        ([feature("LineString", [1.0, 2.0], route_id="r")], "not numbers in pairs"),
        ([stop("a", -75.35, 39.9)], "0 LineString"),
        ([loop_line(), loop_line()], "2 LineString"),
    ],
)
def test_a_route_that_cannot_be_is_refused_in_one_line(
    tmp_path: Path, features: list[dict[str, Any]], says: str
) -> None:
    path = written(tmp_path, *features)
    with pytest.raises(InputError, match=says) as refused:
        load_route(path)
    assert refused.value.where == str(path)
    assert refused.value.mend
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize("content", ["not json", '{"type": "Topology"}', "[]", "\xff\xfe"])
def test_what_is_not_geojson_is_refused(tmp_path: Path, content: str) -> None:
    path = tmp_path / "route.geojson"
    path.write_bytes(content.encode("latin-1"))
    with pytest.raises(InputError, match="is not a GeoJSON FeatureCollection"):
        load_route(path)


def test_a_missing_file_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no such file"):
        load_route(tmp_path / "none.geojson")


def test_stops_out_of_order_are_refused(tmp_path: Path) -> None:
    stops = [stop("second", -75.346, 39.9), stop("first", -75.349, 39.9)]
    line = feature("LineString", LOOP[:3], route_id="r")
    with pytest.raises(InputError, match="stop first is out of order"):
        load_route(written(tmp_path, line, *stops))


def test_order_tells_the_two_passages_of_a_spur_apart() -> None:
    corners = [PLANE.to_geodetic(*p) for p in [(0, 0), (500, 0), (500, 300), (500, 0), (900, 0)]]
    line = Line(*np.array(corners).T)

    def at(name: str, east_m: float, north_m: float) -> StopPlace:
        return StopPlace(name, name, *PLANE.to_geodetic(east_m, north_m))

    stops = [at("in", 501, 100), at("tip", 500, 300), at("out", 499, 100), at("end", 900, 0)]
    alongs_m = [stop.distance_m for stop in place_stops("test", line, stops, loop=False)]
    assert alongs_m == pytest.approx([600.0, 800.0, 1000.0, 1500.0], abs=0.1)


def test_a_written_route_is_read_back_as_it_was(tmp_path: Path) -> None:
    route = load_route(DEMO_ROUTE)
    write_route(route, tmp_path / "copy.geojson")
    assert (tmp_path / "copy.geojson").read_bytes() == DEMO_ROUTE.read_bytes()
    copy = load_route(tmp_path / "copy.geojson")
    assert copy.stops == route.stops
    assert copy.speeds_mps.tolist() == route.speeds_mps.tolist()


def test_an_unwritable_place_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="cannot be written"):
        write_route(load_route(DEMO_ROUTE), tmp_path / "none" / "copy.geojson")


def test_the_demo_route_is_the_published_loop() -> None:
    """1821.8 m and a closing leg of 8.5 m (data/papers README), planned in 189.2 s and 0.6 s."""
    route = load_route(DEMO_ROUTE)
    assert route.loop
    assert len(route.stops) == 5
    assert route.length_m == pytest.approx(1830.3, abs=0.1)
    assert route.duration_s == pytest.approx(189.8, abs=0.1)
    assert np.all(np.diff(route.stop_distances_m) > 100.0)


@pytest.fixture
def two_speeds() -> Route:
    lats, lons = np.array([PLANE.to_geodetic(*p) for p in [(0, 0), (100, 0), (0, 0)]]).T
    return Route(
        route_id="r",
        name="R",
        loop=True,
        line=Line(lats, lons),
        speeds_mps=np.array([10.0, 5.0]),
        stops=(),
    )


def test_planned_time_goes_on_over_the_laps_of_a_loop(two_speeds: Route) -> None:
    distances_m = np.array([0.0, 50.0, 150.0, 200.0, 250.0])
    times_s = two_speeds.time_at(distances_m)
    assert times_s == pytest.approx([0.0, 5.0, 20.0, 30.0, 35.0], abs=1e-3)
    back_m = [two_speeds.distance_at(float(time_s)) for time_s in times_s]
    assert back_m == pytest.approx(distances_m, abs=1e-3)


def test_planned_speed_is_that_of_the_leg(two_speeds: Route) -> None:
    assert (two_speeds.speed_at(99.0), two_speeds.speed_at(101.0)) == (10.0, 5.0)


@pytest.mark.parametrize(
    ("route_id", "stop_id", "name", "said"),
    [
        ("r" * 257, "s", "Stop", r"the route_id 'r{20}'\.\.\. has 257 characters"),
        ("r", "s" * 257, "Stop", r"the stop_id 's{20}'\.\.\. has 257 characters"),
        ("r", "s", "n" * 257, r"the stop's name 'n{20}'\.\.\. has 257 characters"),
    ],
)
def test_a_text_that_no_message_may_carry_is_refused_at_the_start(
    route_id: str, stop_id: str, name: str, said: str
) -> None:
    """Else every reader would drop the arrivals."""
    vertices = [(55.0, 10.0), (55.01, 10.0)]
    stops = [StopPlace(stop_id, name, 55.005, 10.0)]

    def made(route_id: str, stops: list[StopPlace]) -> Route:
        return make_route(
            "test",
            route_id=route_id,
            name="",
            loop=False,
            vertices=vertices,
            speeds_mps=None,
            stops=stops,
        )

    with pytest.raises(InputError, match=said):
        made(route_id, stops)
    assert made("r" * 256, [StopPlace("s" * 256, "n" * 256, 55.005, 10.0)]).length_m > 0.0
