"""Reads the lines of any GeoJSON: features or bare geometries, with ids of whatever kind."""

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import msgspec

from wayline.errors import InputError
from wayline.geojson import RFC, Feature, Geometry
from wayline.stops import StopPlace
from wayline.text_file import read_text
from wayline_cli.imported_line import ImportedLine

Id = str | int | float | None


class AnyObject(msgspec.Struct, frozen=True):
    """A GeoJSON object of any type, with the members of all that may hold a line."""

    type: str
    features: list["AnyObject"] = []
    geometry: "AnyObject | None" = None
    geometries: list["AnyObject"] = []
    coordinates: Any = None
    properties: dict[str, Any] | None = None
    id: Id = None


def lines_of_geojson(path: Path) -> list[ImportedLine]:
    """The lines of a file; where there is one, the points with a `stop_id` are its stops.

    A MultiLineString is one line where each of its parts begins where the one before ends, else a
    line a part. Raises InputError.
    """
    where = str(path)
    try:
        root = msgspec.json.decode(read_text(path), type=AnyObject)
    except msgspec.DecodeError as error:
        raise InputError(where, f"is not GeoJSON ({error})", RFC) from None
    except RecursionError:
        raise InputError(where, "is nested too deep to be GeoJSON", RFC) from None
    features = list(_features(root))
    lines = [line for feature in features for line in _lines(where, feature)]
    stops = [stop for feature in features for stop in _stops(where, feature)]
    return [lines[0]._replace(stops=stops)] if len(lines) == 1 else lines


def _features(
    node: AnyObject, owner: AnyObject | None = None
) -> Iterator[tuple[AnyObject, AnyObject]]:
    """Every geometry with the object whose properties are its own."""
    if node.type == "FeatureCollection":
        for feature in node.features:
            yield from _features(feature)
    elif node.type == "Feature":
        if node.geometry is not None:
            yield from _features(node.geometry, node)
    elif node.type == "GeometryCollection":
        for geometry in node.geometries:
            yield from _features(geometry, owner)
    else:
        yield node, owner or node


def _lines(where: str, feature: tuple[AnyObject, AnyObject]) -> Iterator[ImportedLine]:
    geometry, owner = feature
    if geometry.type not in ("LineString", "MultiLineString"):
        return
    listed = [geometry.coordinates] if geometry.type == "LineString" else geometry.coordinates
    if not isinstance(listed, list):
        raise InputError(where, f"a {geometry.type} without coordinates", RFC)
    parts = [_places(where, coordinates) for coordinates in listed]
    properties = owner.properties or {}
    speeds = properties.get("speeds_mps")
    for vertices in _joined([part for part in parts if part]):
        yield ImportedLine(
            line_id=_text(_first(properties.get("route_id"), owner.id, properties.get("id"))),
            name=_text(_first(properties.get("name"), properties.get("route_long_name"))),
            vertices=vertices,
            speeds_mps=None if speeds is None else _speeds(where, speeds),
            loop=properties.get("loop") is True,
        )


def _joined(parts: Sequence[list[tuple[float, float]]]) -> list[list[tuple[float, float]]]:
    """The parts as one where they follow each other, else as they are."""
    whole: list[tuple[float, float]] = []
    for part in parts:
        if whole and whole[-1] != part[0]:
            return list(parts)
        whole += part
    return [whole] if whole else []


def _stops(where: str, feature: tuple[AnyObject, AnyObject]) -> Iterator[StopPlace]:
    geometry, owner = feature
    properties = owner.properties or {}
    stop_id = _text(properties.get("stop_id"))
    if geometry.type == "Point" and stop_id:
        [(lat_deg, lon_deg)] = _places(where, [geometry.coordinates])
        dwell_s = properties.get("dwell_s")
        dwell_s = float(dwell_s) if isinstance(dwell_s, int | float) and dwell_s > 0.0 else 0.0
        name = _text(_first(properties.get("name"), properties.get("stop_name"))) or stop_id
        yield StopPlace(stop_id, name, lat_deg, lon_deg, dwell_s)


def _places(where: str, coordinates: Any) -> list[tuple[float, float]]:
    return Feature(Geometry("LineString", coordinates)).positions(where, "the line")


def _speeds(where: str, speeds: Any) -> list[float]:
    try:
        return msgspec.convert(speeds, list[float])
    except msgspec.ValidationError as error:
        raise InputError(where, f"speeds_mps: {error}", "correct or remove it") from None


def _first(*values: Any) -> Any:
    return next((value for value in values if value is not None and value != ""), None)


def _text(value: Any) -> str:
    """An id or name as text: 12 and 12.0 are `12`."""
    if isinstance(value, float) and value.is_integer():
        value = int(value)
    return str(value).strip() if isinstance(value, str | int | float) else ""
