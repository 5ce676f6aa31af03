"""Routes from the files that people have, through `wayline route import`."""

import gzip
import json
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

from wayline.errors import InputError
from wayline.route import DEFAULT_SPEED_MPS, Route
from wayline.route_file import load_route
from wayline_cli.__main__ import app

ROUTES = Path(__file__).parent / "routes"
Import = Callable[..., Route]


def run(source: Path, out: Path, *options: str) -> Route:
    """Raises what the command would say in its line."""
    result = CliRunner().invoke(app, ["route", "import", str(source), "--out", str(out), *options])
    if isinstance(result.exception, InputError):
        raise result.exception
    assert result.exit_code == 0, result.output
    return load_route(out)


@pytest.fixture
def imported(tmp_path: Path) -> Import:
    """The route that is made of a file of this name and content."""

    def make(name: str, content: str | bytes, *options: str) -> Route:
        source = tmp_path / name
        source.write_bytes(content.encode() if isinstance(content, str) else content)
        return run(source, tmp_path / "out.geojson", *options)

    return make


@pytest.mark.parametrize("name", ["tab", "decimal_comma", "gtfs_shapes", "recorded"])
def test_csv_as_people_have_it_is_a_route(name: str, tmp_path: Path) -> None:
    """Tabs, Excel's decimal commas, GTFS's own names, a recorded drive that stood."""
    route = run(ROUTES / f"{name}.csv", tmp_path / "r.geojson")
    assert route.length_m == pytest.approx(222.4, abs=0.2)
    speeds = {"gtfs_shapes": [DEFAULT_SPEED_MPS] * 2, "recorded": [2.0, 4.0]}
    assert route.speeds_mps.tolist() == speeds.get(name, [8.0, 8.0])


def test_a_vertex_on_another_continent_is_refused(tmp_path: Path) -> None:
    """Its latitude and longitude are exchanged, or one of them is wrong."""
    with pytest.raises(InputError, match=r"a leg of 10,832 km .*exchange its latitude"):
        run(ROUTES / "swapped.csv", tmp_path / "r.geojson")
    assert not (tmp_path / "r.geojson").exists()


PLAIN = "lat,lon,speed\n48.1,11.5,8\n48.101,11.5,8\n"


@pytest.mark.parametrize(
    "content",
    [
        PLAIN.encode("utf-16"),
        PLAIN.encode("utf-8-sig"),
        gzip.compress(PLAIN.encode()),
        ("sep=,\n" + PLAIN).encode(),
        PLAIN.replace("\n", "\r").encode(),
        PLAIN.replace(",", " ; ").encode(),
        PLAIN.replace("lat,lon", "GPS Latitude (\xb0),GPS Longitude (\xb0)").encode("cp1252"),
        PLAIN.replace("lat,lon", "vehicle,LATITUDE,Long.")
        .replace("\n4", "\nM\xfcller,4")
        .encode("cp1252"),
        PLAIN.replace("speed", "speed_limit,speed_kmh").replace(",8", ",130,28.8").encode(),
    ],
)
def test_csv_of_any_export_is_read(imported: Import, content: bytes) -> None:
    """Encodings, delimiters, names with words around them."""
    route = imported("line.csv", content)
    assert route.speeds_mps == pytest.approx([8.0])
    assert route.length_m == pytest.approx(111.2, abs=0.1)


def test_shapes_of_a_feed_are_lines_to_choose_from(imported: Import) -> None:
    """Rows in any order, put in theirs."""
    shapes = "shape_id,shape_pt_lat,shape_pt_lon,shape_pt_sequence\nB,1,2,1\nB,1,2.001,2\n"
    shapes += "A,48.2,11.5,20\nA,48.1,11.5,3\n"
    with pytest.raises(InputError, match=r"holds 2 lines \(B, A\); name one by --line"):
        imported("shapes.txt", shapes)
    route = imported("shapes.txt", shapes, "--line", "A")
    assert (route.route_id, route.line.lats_deg.tolist()) == ("A", [48.1, 48.2])


GPX = """<?xml version="1.0" encoding="{encoding}"?>
<gpx version="1.1" creator="t" xmlns="http://www.topografix.com/GPX/1/1">
{lines}</gpx>"""
TRACK = """<trk><name>Caf\xe9</name>
<trkseg><trkpt lat="48.1" lon="11.5"><ele>500</ele>
<time>2026-01-01T10:00:00Z</time></trkpt></trkseg>
<trkseg><trkpt lat="48.101" lon="11.5"><time>2026-01-01T10:00:10Z</time></trkpt></trkseg></trk>
"""
PLANNED = '<rte><rtept lat="48.1" lon="11.5"/><rtept lat="48.102" lon="11.5"/></rte>\n'


@pytest.mark.parametrize(
    ("encoding", "mark"),
    [("UTF-8", b""), ("UTF-8", b"\xef\xbb\xbf"), ("UTF-16", b""), ("windows-1252", b"")],
)
def test_a_track_is_a_route_at_the_speeds_of_its_times(
    imported: Import, encoding: str, mark: bytes
) -> None:
    """Its segments joined, in any encoding, with a byte order mark or without."""
    text = GPX.format(encoding=encoding, lines=TRACK)
    route = imported("track.gpx", mark + text.encode(encoding))
    assert (route.route_id, route.name) == ("track", "Caf\xe9")
    assert route.speeds_mps == pytest.approx([11.12], abs=0.01)


def test_a_planned_gpx_route_has_the_usual_speed(imported: Import) -> None:
    route = imported("plan.xml", GPX.format(encoding="UTF-8", lines=PLANNED), "--name", "Plan")
    assert (route.route_id, route.name) == ("plan", "Plan")
    assert route.speeds_mps.tolist() == [DEFAULT_SPEED_MPS]


def test_one_of_several_gpx_lines_is_named(imported: Import) -> None:
    both = GPX.format(encoding="UTF-8", lines=TRACK + PLANNED)
    with pytest.raises(InputError, match=r"holds 2 lines \(Caf\xe9, 2\)"):
        imported("both.gpx", both)
    assert imported("both.gpx", both, "--line", "2").length_m == pytest.approx(222.4, abs=0.2)
    with pytest.raises(InputError, match="no such line"):
        imported("both.gpx", both, "--line", "3")


COORDINATES = [[11.5, 48.1], [11.5, 48.101, 500.0], [11.5, 48.102]]
LINE = {"type": "LineString", "coordinates": COORDINATES}
PARTS = {"type": "MultiLineString", "coordinates": [COORDINATES]}
FOLLOWING = {"type": "MultiLineString", "coordinates": [COORDINATES[:2], COORDINATES[1:]]}


def feature(
    geometry: dict[str, Any], properties: dict[str, Any] | None = None, **more: Any
) -> dict[str, Any]:
    return {"type": "Feature", "geometry": geometry, "properties": properties, **more}


@pytest.mark.parametrize(
    ("root", "route_id", "name"),
    [
        (LINE, "street", "street"),
        (PARTS, "street", "street"),
        (FOLLOWING, "street", "street"),
        (feature(LINE), "street", "street"),
        (feature(LINE, {"name": "Ring"}, id=7), "7", "Ring"),
        (feature(PARTS, {"route_id": 12.0, "name": ""}), "12", "12"),
        (feature(LINE, {"id": "way/4"}), "way/4", "way/4"),
        ({"type": "GeometryCollection", "geometries": [LINE]}, "street", "street"),
        (
            {"type": "FeatureCollection", "features": [feature(LINE, {"route_id": "5A"})]},
            "5A",
            "5A",
        ),
    ],
)
def test_any_geojson_line_is_a_route(
    imported: Import, root: dict[str, Any], route_id: str, name: str
) -> None:
    """Bare, in a feature, in parts; with an id of whatever kind, or none."""
    route = imported("street.geojson", json.dumps(root))
    assert (route.route_id, route.name) == (route_id, name)
    assert route.length_m == pytest.approx(222.4, abs=0.2)


def test_a_route_keeps_its_stops_speeds_and_loop(imported: Import) -> None:
    """Points without a stop_id are something else."""
    square = {"type": "LineString", "coordinates": [*COORDINATES, [11.501, 48.1], COORDINATES[0]]}
    line = feature(square, {"loop": True, "speeds_mps": [5, 6, 7, 8]})
    stop = feature({"type": "Point", "coordinates": [11.5, 48.101]}, {"stop_id": 3, "dwell_s": 20})
    sight = feature({"type": "Point", "coordinates": [12.0, 48.0]}, {"name": "Tower"})
    features = {"type": "FeatureCollection", "features": [stop, line, sight]}
    route = imported("town.json", json.dumps(features).encode("utf-16"), "--route-id", "r1")
    assert (route.route_id, route.loop, route.speeds_mps.tolist()) == ("r1", True, [5, 6, 7, 8])
    assert [(each.stop_id, each.dwell_s) for each in route.stops] == [("3", 20.0)]


@pytest.mark.parametrize(
    ("name", "content", "says"),
    [
        ("a.geojson", '{"type":"Feature","geometry":null}', "holds no line"),
        ("a.geojson", '{"features":[]}', "is not GeoJSON"),
        ("a.geojson", '{"type":"LineString"', "is not GeoJSON"),
        (
            "a.geojson",
            '{"type":"LineString","coordinates":[[11.5,98.1],[11.5,98.2]]}',
            "write longitude first",
        ),
        (
            "a.geojson",
            '{"type":"MultiLineString","coordinates":[[[1,2],[1,2.1]],[[3,4],[3,4.1]]]}',
            "holds 2 lines",
        ),
        ("a.geojson", '{"type":"MultiLineString","coordinates":null}', "without coordinates"),
        ("a.geojson", "[" * 100_000, "is not GeoJSON"),
        ("a.geojson", '{"type":"Point","coordinates":' + "[" * 100_000, "nested too deep"),
        ("a.gpx", "<gpx><trk><trkpt lat='48'/></trk></gpx>", "is not GPX"),
        ("a.gpx", "<gpx><wpt lat='48' lon='11'/></gpx>", "holds no line"),
        ("a.gpx", "<gpx><trk>", "is not GPX"),
        ("a.kml", "<?xml version='1.0'?><kml/>", "is KML; give CSV, GPX, GeoJSON"),
        ("a.pdf", "%PDF-1.7", "is a PDF"),
        ("a.csv", "48,1,11,5\n48,2,11,5\n", "no column for latitude"),
        (
            "a.csv",
            "lat,lon\n11,148\n148,11\n",
            "line 3: '148' is not a number in range; .*exchange",
        ),
        ("a.csv", gzip.compress(PLAIN.encode() * 1000)[:60], "was cut or damaged"),
    ],
)
def test_what_is_no_route_is_refused_in_one_line(
    imported: Import, name: str, content: str | bytes, says: str
) -> None:
    with pytest.raises(InputError, match=says) as refused:
        imported(name, content)
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize(
    ("member", "says"),
    [
        ("xl/workbook.xml", "is an Excel workbook"),
        ("doc.kml", "is KMZ"),
        ("a.txt", "holds no trip"),
    ],
)
def test_other_packed_files_are_refused_by_name(tmp_path: Path, member: str, says: str) -> None:
    source = tmp_path / "line.zip"
    with zipfile.ZipFile(source, "w") as archive:
        archive.writestr(member, "")
    with pytest.raises(InputError, match=says):
        run(source, tmp_path / "r.geojson")


TRIPS = "route_id,trip_id\n7,t1\n"
FEED = {
    "stops.txt": (
        "stop_id,stop_name,stop_lat,stop_lon\na,Caf\xe9,60.0,20.0\nb,M\xfchle,60.01,20.0\n"
    ),
    "stop_times.txt": (
        "trip_id, stop_id, arrival_time, departure_time, stop_sequence\n"
        "t1,a,10:00:00,10:00:30,1\nt1,b,10:01:30,10:01:30,2\n"
    ),
}


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "cp1252"])
@pytest.mark.parametrize("folder", ["", "feed/"])
def test_the_only_trip_of_a_feed_needs_no_name(tmp_path: Path, encoding: str, folder: str) -> None:
    """Packed with its folder or without, in any encoding."""
    source = tmp_path / "feed.zip"
    with zipfile.ZipFile(source, "w") as archive:
        for table, text in {**FEED, "trips.txt": TRIPS}.items():
            archive.writestr(folder + table, text.encode(encoding))
    route = run(source, tmp_path / "r.geojson")
    assert [stop.name for stop in route.stops] == ["Caf\xe9", "M\xfchle"]


@pytest.mark.parametrize(
    ("trips", "says"),
    [
        (TRIPS + "7,t2\n", r"is a GTFS feed of 2 trips; name one .* e\.g\. t1, t2"),
        ("route_id,trip_id\n", "holds no trip"),
    ],
)
def test_a_feed_is_said_to_have_the_trips_that_it_has(
    tmp_path: Path, trips: str, says: str
) -> None:
    both = FEED["stop_times.txt"] + FEED["stop_times.txt"].partition("\n")[2].replace("t1", "t2")
    for table, text in {**FEED, "trips.txt": trips, "stop_times.txt": both}.items():
        (tmp_path / table).write_text(text, encoding="utf-8")
    with pytest.raises(InputError, match=says):
        run(tmp_path, tmp_path / "r.geojson")
