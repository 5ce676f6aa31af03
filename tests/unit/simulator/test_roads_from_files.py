"""Roads along the line of a file: near it, smooth, and with its stops, speeds and altitudes."""

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from wayline.errors import InputError
from wayline.line import Line
from wayline.route_file import load_route, write_route
from wayline_simulator.closing import gap_of
from wayline_simulator.course import Course
from wayline_simulator.course_route import route_of
from wayline_simulator.road import make_course
from wayline_simulator.road_model import Kind, RoadModel

LAT_DEG, LON_DEG = 59.0, 17.0
NORTH_DEG, EAST_DEG = 1.0 / 111_389.0, 1.0 / 57_474.0
"""Degrees of a metre there, to a few parts in 10,000."""


def along(path: Path, *, loop: bool | None = None) -> Course:
    """The course of a file."""
    return make_course(RoadModel(kind="file", path=path.name, loop=loop), 1, path.parent)


def offsets_m(course: Course, line: Line) -> list[float]:
    """Of every hundredth sample from a line."""
    places = zip(course.lats_deg[::100], course.lons_deg[::100], strict=True)
    return [float(line.project_legs(lat, lon).offsets_m.min()) for lat, lon in places]


def write_line(path: Path, metres: list[tuple[float, ...]], **properties: object) -> Path:
    """A GeoJSON line through points in metres east and north, maybe with altitudes."""
    coordinates = [
        [LON_DEG + east * EAST_DEG, LAT_DEG + north * NORTH_DEG, *rest]
        for east, north, *rest in metres
    ]
    shape = {"type": "LineString", "coordinates": coordinates}
    feature = {"type": "Feature", "geometry": shape, "properties": properties}
    path.write_text(json.dumps({"type": "FeatureCollection", "features": [feature]}))
    return path


def test_a_right_angle_becomes_a_bend_that_can_be_driven(tmp_path: Path) -> None:
    """No radius below 6 m, no farther than 6 m from the corner, and a quarter turn in all."""
    path = write_line(tmp_path / "line.json", [(0.0, 0.0), (0.0, 200.0), (200.0, 200.0)])
    course = along(path)
    assert 6.0 <= 1.0 / np.abs(course.curvature_per_m).max() < 12.0
    turned_deg = np.degrees(course.headings_rad[-1] - course.headings_rad[0])
    assert turned_deg == pytest.approx(90.0, abs=0.3)
    line = Line(
        LAT_DEG + np.array([0.0, 200.0, 200.0]) * NORTH_DEG,
        LON_DEG + np.array([0.0, 0.0, 200.0]) * EAST_DEG,
    )
    offsets = np.array(offsets_m(course, line))
    assert offsets.max() < 6.0
    assert np.sqrt(np.mean(offsets**2)) < 2.0


def test_a_bend_drawn_with_few_points_has_a_steady_radius(tmp_path: Path) -> None:
    """A quarter of a circle of 300 m with a point every 40 m bends by 1 / 300 m, not in kinks."""
    angles = np.linspace(0.0, np.pi / 2.0, 13)
    arc = [(300.0 - 300.0 * np.cos(a), 300.0 * np.sin(a)) for a in angles]
    course = along(write_line(tmp_path / "arc.json", [tuple(map(float, p)) for p in arc]))
    middle = course.curvature_per_m[150:-150]
    assert 300.0 * middle.mean() == pytest.approx(1.0, abs=0.02)
    assert 300.0 * np.std(middle) < 0.2


def test_altitudes_of_a_file_are_the_road_s(tmp_path: Path) -> None:
    """The third coordinate makes the grade, and grade makes the altitude."""
    metres = [(0.0, 100.0 * i, 20.0 + 3.0 * i) for i in range(11)]
    course = along(write_line(tmp_path / "hill.json", list(metres)))
    assert course.alts_m[[0, -1]] == pytest.approx([20.0, 50.0], abs=0.3)
    assert course.grade[200:-200] == pytest.approx(0.03, abs=0.001)


@pytest.mark.parametrize("kind", ["urban", "hills", "motorway"])
def test_a_course_written_as_a_route_is_the_same_road_again(kind: Kind, tmp_path: Path) -> None:
    """Within 0.5 m RMS; its stops, limits and length are kept."""
    first = make_course(RoadModel(kind=kind, length_m=12_000.0, stops=4), 3)
    route = route_of(first, "r1", "Road one")
    write_route(route, tmp_path / "route.geojson")
    again = along(tmp_path / "route.geojson")
    assert np.sqrt(np.mean(np.square(offsets_m(again, route.line)))) < 0.5
    assert again.length_m == pytest.approx(first.length_m, rel=0.01)
    assert again.loop == first.loop
    stops = [[h for h in course.halts if h.kind == "stop"] for course in (first, again)]
    assert [s.name for s in stops[0]] == [s.name for s in stops[1]]
    for before, behind in zip(*stops, strict=True):
        at, to = round(2.0 * before.distance_m), round(2.0 * behind.distance_m)
        apart = Line(
            np.array([first.lats_deg[at], again.lats_deg[to]]),
            np.array([first.lons_deg[at], again.lons_deg[to]]),
        )
        assert apart.length_m < 3.0
    assert set(again.limits_mps.round(2)) == set(first.limits_mps.round(2))


def test_a_route_reads_back_as_it_was_written(tmp_path: Path) -> None:
    """Vertices at most 10 m apart, stops where the course has them, a loop that is closed."""
    course = make_course(RoadModel(kind="hills", stops=3), 2)
    route = route_of(course, "hills", "Hills")
    write_route(route, tmp_path / "route.geojson")
    read = load_route(tmp_path / "route.geojson")
    assert read.loop
    assert read.line.legs_m.max() < 10.6
    assert read.length_m == pytest.approx(course.length_m, abs=1.0)
    stops_m = [halt.distance_m for halt in course.halts if halt.kind == "stop"]
    assert read.stop_distances_m == pytest.approx(stops_m, abs=1.0)


def test_a_loop_of_a_file_closes(tmp_path: Path) -> None:
    """A square that says loop ends where it began, though its file does not repeat the point."""
    square = [(0.0, 0.0, 5.0), (0.0, 400.0, 25.0), (300.0, 400.0, 5.0), (300.0, 0.0, 0.0)]
    course = along(write_line(tmp_path / "square.json", list(square)), loop=True)
    gap = gap_of(course)
    assert np.hypot(gap.east_m, gap.north_m) < 1e-3
    assert abs(gap.turn_rad) < 1e-6
    assert course.alts_m[-1] == pytest.approx(course.alts_m[0], abs=1e-3)
    assert course.length_m == pytest.approx(1400.0, abs=40.0)


def test_a_long_line_stays_on_its_place(tmp_path: Path) -> None:
    """Thirty kilometres of straight legs across the meridians end within a metre."""
    metres = [(3000.0 * i, 300.0 * (i % 2)) for i in range(11)]
    path = write_line(tmp_path / "long.json", [tuple(map(float, p)) for p in metres])
    course = along(path)
    end = Line(
        np.array([course.lats_deg[-1], LAT_DEG]),
        np.array([course.lons_deg[-1], LON_DEG + 30_000.0 * EAST_DEG]),
    )
    assert end.length_m < 1.0


def test_a_gpx_track_with_elevations_is_read(tmp_path: Path) -> None:
    """Points of a track in its namespace, and their ele."""
    rows = "".join(
        f'<trkpt lat="{LAT_DEG + i * 50.0 * NORTH_DEG:.8f}" lon="17"><ele>{10 + i}</ele></trkpt>'
        for i in range(20)
    )
    path = tmp_path / "track.gpx"
    path.write_text(
        f'<gpx xmlns="http://www.topografix.com/GPX/1/1"><trk><trkseg>{rows}</trkseg></trk></gpx>'
    )
    course = along(path)
    assert course.length_m == pytest.approx(950.0, abs=2.0)
    assert course.grade[300:-300] == pytest.approx(0.02, abs=0.001)


def test_an_earlier_drive_s_truth_is_a_road(tmp_path: Path) -> None:
    """Its standstills vanish and its altitudes stay."""
    first = make_course(RoadModel(kind="main", length_m=3_000.0), 4)
    lines = ["t_s,lat_deg,lon_deg,alt_m"]
    at = np.concatenate((np.zeros(50, dtype=int), np.arange(0, len(first.lats_deg), 20)))
    lines += [
        f"{i},{first.lats_deg[k]:.8f},{first.lons_deg[k]:.8f},{first.alts_m[k]:.3f}"
        for i, k in enumerate(at)
    ]
    (tmp_path / "truth.csv").write_text("\n".join(lines) + "\n")
    course = along(tmp_path / "truth.csv")
    assert max(offsets_m(course, Line(first.lats_deg[::10], first.lons_deg[::10]))) < 0.3
    assert course.alts_m.max() == pytest.approx(first.alts_m.max(), abs=0.5)


def test_a_recorded_drive_without_line_is_refused(recorded: Callable[[str], Path]) -> None:
    """A folder with neither truth nor route says so."""
    with pytest.raises(InputError, match="without truth and without route"):
        along(recorded("css-164"))


@pytest.mark.parametrize(
    ("name", "content", "what"),
    [
        ("missing.gpx", None, "no such file"),
        ("empty.gpx", "<gpx/>", "0 points"),
        ("broken.gpx", "<gpx>", "is not GPX"),
        ("text.json", "hello", "not a GeoJSON"),
        ("truth.csv", "t_s,lat_deg\n1,2\n", "no numbers in lat_deg and lon_deg"),
        ("truth.csv", "lat_deg,lon_deg\n59,17\n59.0001,17\n", "a line of 11 m"),
        ("truth.csv", "lat_deg,lon_deg\n59,17\n59.01,17\n59,17\n", "turns back on itself"),
    ],
)
def test_a_file_without_a_drivable_line_is_refused(
    name: str, content: str | None, what: str, tmp_path: Path
) -> None:
    """With what is wrong about it."""
    if content is not None:
        (tmp_path / name).write_text(content)
    with pytest.raises(InputError, match=what):
        along(tmp_path / name)


def test_long_legs_stay_straight(tmp_path: Path) -> None:
    """A road of legs of half a kilometre that bend by 15 degrees is nowhere 2 m off its line."""
    metres = [(0.0, 0.0), (0.0, 500.0), (130.0, 985.0), (130.0, 1485.0)]
    course = along(write_line(tmp_path / "legs.json", list(metres)))
    places = np.array(metres)
    line = Line(LAT_DEG + places[:, 1] * NORTH_DEG, LON_DEG + places[:, 0] * EAST_DEG)
    assert max(offsets_m(course, line)) < 2.0
