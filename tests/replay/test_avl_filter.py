"""The published route filter reproduces the estimates that papers/000 prints in appendix D."""

import csv
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from wayline.geo import metres_per_degree
from wayline.route import Route
from wayline.route_file import load_route
from wayline_cli.route_import import Wishes, import_route
from wayline_eta.avl_filter import AvlRouteFilter, Estimate

FIRST_ROW, LAST_ROW = 10, 196
DEMO_ROUTE = Path(__file__).parents[2] / "deploy" / "demo" / "avl-shuttle" / "route.geojson"

Recorded = Callable[[str], Path]


def rows(path: Path) -> list[dict[str, str]]:
    with path.open(encoding="ascii", newline="") as file:
        return list(csv.DictReader(file))


def replay(route: Route, papers: Path, *, use_repeats: bool = False) -> list[Estimate]:
    route_filter = AvlRouteFilter(route)
    estimates = []
    for row in rows(papers / "avl-gps-samples.csv"):
        known = use_repeats or row["is_repeat"] == "0"
        position = float(row["latitude_deg"]), float(row["longitude_deg"])
        estimate = route_filter.step(position if known else None)
        assert estimate is not None
        estimates.append(estimate)
    return estimates


def errors_m(estimates: list[Estimate], papers: Path) -> NDArray[np.float64]:
    """Latitude and longitude errors against the 187 printed rows, shape (187, 2)."""
    printed = np.array(
        [
            (float(row["latitude_deg"]), float(row["longitude_deg"]))
            for row in rows(papers / "avl-ekf-estimates.csv")
        ]
    )
    ours = np.array([(e.lat_deg, e.lon_deg) for e in estimates[FIRST_ROW - 1 : LAST_ROW]])
    return np.asarray((ours - printed) * np.array(metres_per_degree(39.908)))


@pytest.fixture(params=["open", "loop"])
def route(request: pytest.FixtureRequest, recorded: Recorded) -> Route:
    if request.param == "loop":
        return load_route(DEMO_ROUTE)
    path = recorded("papers") / "avl-planned-route.csv"
    return import_route(path, Wishes("target-shuttle", "Target shuttle", loop=False))


def test_printed_estimates_are_reproduced(route: Route, recorded: Recorded) -> None:
    errors = errors_m(replay(route, recorded("papers")), recorded("papers"))
    lat_m, lon_m = np.abs(errors).T
    flat_m = np.hypot(lat_m, lon_m)
    assert len(flat_m) == 187
    assert lat_m.mean() <= 0.45
    assert lat_m.max() <= 1.8
    assert lon_m.mean() <= 2.1
    assert np.sqrt(np.mean(flat_m**2)) <= 2.7
    assert flat_m.max() <= 6.5


def test_repeats_must_be_predicted_only(recorded: Recorded) -> None:
    estimates = replay(load_route(DEMO_ROUTE), recorded("papers"), use_repeats=True)
    errors = errors_m(estimates, recorded("papers"))
    assert np.hypot(*errors.T).max() > 40.0


def test_open_route_ends_at_the_last_printed_row(recorded: Recorded) -> None:
    path = recorded("papers") / "avl-planned-route.csv"
    route = import_route(path, Wishes("target-shuttle", "Target shuttle", loop=False))
    ended = [estimate.ended for estimate in replay(route, recorded("papers"))]
    assert ended.index(True) + 1 == LAST_ROW
