"""Pure: which road a place lies on: points of all roads in a grid of cells on the ground."""

import math
from collections.abc import Iterable
from typing import NamedTuple

import numpy as np

from wayline.geo import metres_per_degree, wrap_180
from wayline_slope_map.roads import Road

SPACING_M = 10.0
"""Between the points that stand for a road, and between the places of a run."""
ROUTE_WITHIN_M = 40.0
ROAD_WITHIN_M = 25.0
HEADING_WITHIN_DEG = 35.0
"""Streets that cross at more never match, at 30 to 35 degrees for less than 100 m."""
CELL_DEG = 0.0005
"""Of latitude, 55 m: more than the furthest match."""
CONTINUES_WITHIN_M = 30.0
"""How far a place along a road may lie from where the last one and the distance put it."""


class Match(NamedTuple):
    """A place on a road: direction of travel, distance along the road's line, distance beside it.

    `along_m` may lie a few metres before the start or after the end.
    """

    road_id: str
    direction: int
    along_m: float
    offset_m: float


def on_road(road: Road, match: Match) -> Match:
    """A place as it lies on the road's line: a loop goes on after its end, another road ends."""
    length_m = road.line.length_m
    along_m = match.along_m % length_m if road.loop else min(max(match.along_m, 0.0), length_m)
    return match._replace(along_m=along_m)


def carried_on(road: Road, match: Match, moved_m: float) -> Match:
    """A place after so much more travel along its road, in its direction."""
    return on_road(road, match._replace(along_m=match.along_m + match.direction * moved_m))


class _Point(NamedTuple):
    road_id: str
    along_m: float
    lat_deg: float
    lon_deg: float
    heading_deg: float
    one_way: bool
    within_m: float


class RoadIndex:
    """Finds the roads near a place that run its way or the opposite way."""

    def __init__(self, roads: Iterable[Road] = ()) -> None:
        self._cells: dict[tuple[int, int], list[_Point]] = {}
        self._rows: dict[int, tuple[float, float]] = {}
        self._road_ids: set[str] = set()
        for road in roads:
            self.add(road)

    def add(self, road: Road) -> None:
        """Make a road known; a second time changes nothing."""
        if road.road_id in self._road_ids:
            return
        self._road_ids.add(road.road_id)
        within_m = ROUTE_WITHIN_M if road.is_route else ROAD_WITHIN_M
        length_m = road.line.length_m
        for along_m in [*np.arange(0.0, length_m, SPACING_M).tolist(), length_m]:
            at = road.line.point_at(along_m)
            self._put(_Point(road.road_id, along_m, *at, road.is_route, within_m))

    def add_place(
        self, road_id: str, along_m: float, lat_deg: float, lon_deg: float, heading_deg: float
    ) -> None:
        """Make one point of a path known, whose distance along it is given."""
        self._put(_Point(road_id, along_m, lat_deg, lon_deg, heading_deg, False, ROAD_WITHIN_M))

    def near(self, lat_deg: float, lon_deg: float, heading_deg: float) -> list[Match]:
        """Every road point near a place as a match, a road several times where it is near twice."""
        row = math.floor(lat_deg / CELL_DEG)
        north_m_per_deg, east_m_per_deg = self._scales(row)
        matches = []
        for cell in self._around(row, lon_deg):
            for point in self._cells.get(cell, ()):
                east_m = wrap_180(lon_deg - point.lon_deg) * east_m_per_deg
                north_m = (lat_deg - point.lat_deg) * north_m_per_deg
                match = _matched(point, east_m, north_m, heading_deg)
                if match is not None:
                    matches.append(match)
        return matches

    def _put(self, point: _Point) -> None:
        row = math.floor(point.lat_deg / CELL_DEG)
        self._cells.setdefault((row, self._column(row, point.lon_deg)), []).append(point)

    def _around(self, row: int, lon_deg: float) -> Iterable[tuple[int, int]]:
        for near_row in (row - 1, row, row + 1):
            column = self._column(near_row, lon_deg)
            for near_column in (column - 1, column, column + 1):
                yield near_row, near_column

    def _column(self, row: int, lon_deg: float) -> int:
        north_m_per_deg, east_m_per_deg = self._scales(row)
        return math.floor(wrap_180(lon_deg) * east_m_per_deg / (north_m_per_deg * CELL_DEG))

    def _scales(self, row: int) -> tuple[float, float]:
        if row not in self._rows:
            self._rows[row] = metres_per_degree(row * CELL_DEG)
        return self._rows[row]


def _matched(point: _Point, east_m: float, north_m: float, heading_deg: float) -> Match | None:
    if abs(east_m) > ROUTE_WITHIN_M + SPACING_M or abs(north_m) > ROUTE_WITHIN_M + SPACING_M:
        return None
    heading_rad = math.radians(point.heading_deg)
    ahead_m = east_m * math.sin(heading_rad) + north_m * math.cos(heading_rad)
    beside_m = east_m * math.cos(heading_rad) - north_m * math.sin(heading_rad)
    if abs(ahead_m) > SPACING_M or abs(beside_m) > point.within_m:
        return None
    turn_deg = abs(wrap_180(heading_deg - point.heading_deg))
    if turn_deg <= HEADING_WITHIN_DEG:
        direction = 1
    elif turn_deg >= 180.0 - HEADING_WITHIN_DEG and not point.one_way:
        direction = -1
    else:
        return None
    offset_m = math.hypot(beside_m, ahead_m)
    return Match(point.road_id, direction, point.along_m + ahead_m, offset_m)


def chosen(
    candidates: list[Match], last: Match | None, moved_m: float, route_id: str | None = None
) -> Match | None:
    """The match that goes on from the last one, else the nearest; None without candidates.

    `moved_m` is the distance travelled since the last place. The drive's own route goes before
    every other road.
    """
    candidates = [match for match in candidates if match.road_id == route_id] or candidates
    going_on = [
        (abs((match.along_m - last.along_m) * last.direction - moved_m), match)
        for match in candidates
        if last is not None and (match.road_id, match.direction) == last[:2]
    ]
    if going_on:
        apart_m, match = min(going_on, key=lambda pair: (pair[0], pair[1].offset_m))
        if apart_m <= CONTINUES_WITHIN_M + 0.2 * moved_m:
            return match
    return min(candidates, key=lambda match: (match.offset_m, match), default=None)
