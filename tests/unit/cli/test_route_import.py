"""Routes from CSV files as people write them."""

from pathlib import Path

import pytest

from wayline.errors import InputError
from wayline.route import DEFAULT_SPEED_MPS, Route
from wayline_cli.route_import import Wishes, import_route


def route_from_csv(path: Path, route_id: str, name: str, *, loop: bool) -> Route:
    return import_route(path, Wishes(route_id, name, loop))


def csv_file(folder: Path, text: str) -> Path:
    path = folder / "route.csv"
    path.write_text(text, encoding="utf-8")
    return path


POINTS = "39.9,-75.35,18\n39.905,-75.35,9\n39.905,-75.34,4.5\n"


def test_the_speed_of_a_point_is_that_of_the_leg_after_it(tmp_path: Path) -> None:
    path = csv_file(tmp_path, "latitude_deg,longitude_deg,speed_m_s\n" + POINTS)
    route = route_from_csv(path, "r", "R", loop=False)
    assert (route.route_id, route.name, route.loop, route.stops) == ("r", "R", False, ())
    assert route.speeds_mps.tolist() == [18.0, 9.0]
    assert route.line.lats_deg.tolist() == [39.9, 39.905, 39.905]


def test_a_loop_is_closed_at_the_speed_of_its_last_point(tmp_path: Path) -> None:
    path = csv_file(tmp_path, "latitude_deg,longitude_deg,speed_m_s\n" + POINTS)
    route = route_from_csv(path, "r", "R", loop=True)
    assert route.speeds_mps.tolist() == [18.0, 9.0, 4.5]
    assert route.line.lons_deg[-1] == route.line.lons_deg[0]


def test_a_loop_that_is_closed_already_stays_so(tmp_path: Path) -> None:
    path = csv_file(tmp_path, "latitude_deg,longitude_deg,speed_m_s\n" + POINTS + "39.9,-75.35,1\n")
    assert route_from_csv(path, "r", "R", loop=True).speeds_mps.tolist() == [18.0, 9.0, 4.5]


@pytest.mark.parametrize(
    ("header", "factor"),
    [
        ("Latitude,Longitude,Speed (m/s)", 1.0),
        ("lat,lon,speed_kmh", 1 / 3.6),
        ("\ufefflat_deg,lng,Speed km/h", 1 / 3.6),
        ("y,x,speed_mph", 0.44704),
    ],
)
def test_headers_are_recognised_with_their_units(
    tmp_path: Path, header: str, factor: float
) -> None:
    route = route_from_csv(csv_file(tmp_path, f"{header}\n{POINTS}"), "r", "R", loop=False)
    assert route.speeds_mps == pytest.approx([18.0 * factor, 9.0 * factor])


def test_columns_may_come_in_any_order_and_speed_may_be_missing(tmp_path: Path) -> None:
    path = csv_file(tmp_path, "name;lon;lat\na;-75.35;39.9\n\nb;-75.34;39.905\n")
    route = route_from_csv(path, "r", "R", loop=False)
    assert route.line.lats_deg.tolist() == [39.9, 39.905]
    assert route.speeds_mps.tolist() == [DEFAULT_SPEED_MPS]


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("", "no column for latitude"),
        ("lat,speed\n1,2\n", "no column for longitude"),
        ("lat,lon,speed_knots\n1,2,3\n", "column speed_knots has an unknown unit"),
        ("lat,lon\n1,2\n", r"1 point\(s\)"),
        ("lat,lon\n1,2\n95,2\n", r"line 3: '95' is not a number in range"),
        ("lat,lon\n1,2\n1\n", r"line 3: '' is not a number"),
        ("lat,lon,speed\n1,2,fast\n1,3,4\n", "line 2: 'fast'"),
        ("lat,lon,speed\n1,2,nan\n1,3,4\n", "line 2: 'nan'"),
        ("lat,lon,speed\n1,2,0\n1,3,0\n", "no speed is above 0"),
        ("lat,lon,speed\n1,2,-1\n1,3,4\n", "line 2: the speed is below 0"),
    ],
)
def test_a_bad_file_is_refused_with_its_line(tmp_path: Path, text: str, says: str) -> None:
    with pytest.raises(InputError, match=says):
        route_from_csv(csv_file(tmp_path, text), "r", "R", loop=False)


def test_a_missing_file_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no such file"):
        route_from_csv(tmp_path / "none.csv", "r", "R", loop=False)
