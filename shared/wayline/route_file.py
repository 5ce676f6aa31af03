"""Reads and writes routes as GeoJSON (SPEC section 3)."""

from pathlib import Path
from typing import Annotated

import msgspec
import numpy as np
from msgspec import Meta

from wayline.errors import InputError
from wayline.geojson import Feature, Geometry, read_features, read_properties, write_features
from wayline.route import Route, make_route
from wayline.stops import StopPlace


class LineProperties(msgspec.Struct, frozen=True, kw_only=True):
    """Properties of a route file's LineString."""

    route_id: Annotated[str, Meta(min_length=1)]
    name: str | None = None
    loop: bool = False
    speeds_mps: tuple[float, ...] | None = None


class StopProperties(msgspec.Struct, frozen=True, kw_only=True):
    """Properties of a route file's Points."""

    stop_id: Annotated[str, Meta(min_length=1)]
    name: str | None = None
    dwell_s: Annotated[float, Meta(ge=0.0)] = 0.0


def load_route(path: Path) -> Route:
    """Read a route from a GeoJSON file; InputError for what does not fit.

    The Points are its stops, in order of travel. A route without a name is called by its id.
    """
    where = str(path)
    features = read_features(path)
    lines = [feature for feature in features if feature.kind == "LineString"]
    if len(lines) != 1:
        raise InputError(
            where, f"{len(lines)} LineString features", "a route file holds exactly one"
        )
    properties = read_properties(lines[0], where, "the line", LineProperties)
    points = [feature for feature in features if feature.kind == "Point"]
    return make_route(
        where,
        route_id=properties.route_id,
        name=properties.name or properties.route_id,
        loop=properties.loop,
        vertices=lines[0].positions(where, "the line"),
        speeds_mps=properties.speeds_mps,
        stops=[_stop_place(where, point, number) for number, point in enumerate(points, start=1)],
    )


def _stop_place(where: str, point: Feature, number: int) -> StopPlace:
    stop = read_properties(point, where, f"stop {number}", StopProperties)
    [(lat_deg, lon_deg)] = point.positions(where, f"stop {stop.stop_id}")
    return StopPlace(stop.stop_id, stop.name or stop.stop_id, lat_deg, lon_deg, stop.dwell_s)


def route_features(route: Route) -> list[Feature]:
    """The route as GeoJSON features: the line, then the stops in order."""
    line = route.line
    properties = LineProperties(
        route_id=route.route_id,
        name=route.name,
        loop=route.loop,
        speeds_mps=tuple(round(float(speed), 3) for speed in route.speeds_mps),
    )
    positions = np.column_stack((line.lons_deg, line.lats_deg)).tolist()
    stops = [
        Feature(
            Geometry("Point", [stop.lon_deg, stop.lat_deg]),
            {"stop_id": stop.stop_id, "name": stop.name, "dwell_s": stop.dwell_s},
        )
        for stop in route.stops
    ]
    shape = Geometry("LineString", positions)
    return [Feature(shape, msgspec.structs.asdict(properties)), *stops]


def write_route(route: Route, path: Path) -> None:
    """Write a route as GeoJSON that `load_route` reads back; speeds to the mm/s."""
    write_features(route_features(route), path)
