"""A road's profile as files: CSV and GeoJSON, one row or feature a known bin."""

import csv
import io
from collections.abc import Mapping

import numpy as np

from wayline.geojson import Feature, FeatureCollection, Geometry
from wayline.line import Line
from wayline.parameters import read_parameters
from wayline_slope_map.answers import DIRECTIONS, Way
from wayline_slope_map.book import SlopeBook
from wayline_slope_map.export import ExportRow, profile_rows
from wayline_slope_map.profile import RoadProfile
from wayline_slope_map.questions import StretchParameters
from wayline_slope_map.roads import Road


def profile_csv(book: SlopeBook, road_id: str, parameters: Mapping[str, str]) -> str:
    """The rows of `wayline slope export` for one direction of a road (`StretchParameters`).

    Raises QueryError: 422 for an unfit parameter, 404 for a road that is not known.
    """
    asked = read_parameters(parameters, StretchParameters)
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(ExportRow._fields)
    writer.writerows(_rows(book.profile(road_id), asked))
    return text.getvalue()


def profile_geojson(
    book: SlopeBook, road_id: str, parameters: Mapping[str, str]
) -> FeatureCollection:
    """The known bins of a road, each with its piece of the line, in the direction of travel.

    Raises QueryError as `profile_csv`.
    """
    asked = read_parameters(parameters, StretchParameters)
    profile = book.profile(road_id)
    rows = _rows(profile, asked)
    return FeatureCollection([_feature(profile.road, row, asked.direction) for row in rows])


def _rows(profile: RoadProfile, asked: StretchParameters) -> list[ExportRow]:
    rows = profile_rows(profile, DIRECTIONS[asked.direction])
    return [row for row in rows if asked.holds(row.distance_m)]


def _feature(road: Road, row: ExportRow, way: Way) -> Feature:
    from_m = row.distance_m - 0.5 * road.bin_m
    is_last = road.bin_at(row.distance_m) == road.bins - 1
    to_m = road.line.length_m if is_last else row.distance_m + 0.5 * road.bin_m
    piece = _piece(road.line, from_m, to_m)
    return Feature(
        Geometry("LineString", piece if way == "forward" else piece[::-1]), row._asdict()
    )


def _piece(line: Line, from_m: float, to_m: float) -> list[list[float]]:
    """Longitude and latitude of a line's points from one distance to another."""
    inside = np.flatnonzero((line.distances_m > from_m) & (line.distances_m < to_m))
    vertices = [(float(line.lats_deg[i]), float(line.lons_deg[i])) for i in inside]
    ends = [line.point_at(at_m)[:2] for at_m in (from_m, to_m)]
    return [[round(lon, 7), round(lat, 7)] for lat, lon in (ends[0], *vertices, ends[1])]
