"""Pure: all roads as a network for the matcher: points of them in a grid of cells on the ground."""

import math
from collections.abc import Iterable, Sequence
from typing import NamedTuple, Self

import numpy as np

from wayline.geo import metres_per_degree, wrap_180, wrap_360
from wayline.matching.network import Candidate, First, Sight
from wayline_slope_map.roads import Road

SPACING_M = 10.0
"""Between the points that stand for a road, and between the places of a run."""
ROUTE_WITHIN_M = 40.0
ROAD_WITHIN_M = 25.0
HEADING_WITHIN_DEG = 35.0
"""Streets that cross at more never match, at 30 to 35 degrees for less than 100 m."""
CELL_DEG = 0.0005
"""Of latitude, 55 m: more than the furthest match."""
CHANGE_COST = 5.0
"""Lost by a place on another road than the last: about one place in a hundred is."""


class Match(NamedTuple):
    """A place on a road: direction of travel, distance along the road's line, distance beside it.

    `along_m` may lie a few metres before the start or after the end.
    """

    road_id: str
    direction: int
    along_m: float
    offset_m: float

    @classmethod
    def of(cls, candidate: Candidate) -> Self:
        """A candidate that was the likeliest one."""
        return cls(candidate.edge_id, candidate.direction, candidate.along_m, candidate.offset_m)


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
    """Roads as edges, near a place those that run a vehicle's way or the opposite way.

    A road ends nowhere in another: how roads join is not known. One thread makes roads known, any
    others may look meanwhile: what is in a cell is replaced, never changed.
    """

    def __init__(self, roads: Iterable[Road] = ()) -> None:
        self._cells: dict[tuple[int, int], tuple[_Point, ...]] = {}
        self._rows: dict[int, tuple[float, float]] = {}
        self._roads: dict[str, Road] = {}
        for road in roads:
            self.add(road)

    def add(self, road: Road) -> None:
        """Make a road known; a second time changes nothing."""
        if road.road_id in self._roads:
            return
        self._roads[road.road_id] = road
        within_m = ROUTE_WITHIN_M if road.is_route else ROAD_WITHIN_M
        length_m = road.line.length_m
        alongs_m = np.append(np.arange(0.0, length_m, SPACING_M), length_m)
        columns = (each.tolist() for each in (alongs_m, *road.line.points_at(alongs_m)))
        for along_m, lat_deg, lon_deg, heading_deg in zip(*columns, strict=True):
            at = lat_deg, lon_deg, heading_deg
            self._put(_Point(road.road_id, along_m, *at, road.is_route, within_m))

    def add_place(
        self, road_id: str, along_m: float, lat_deg: float, lon_deg: float, heading_deg: float
    ) -> None:
        """Make one point of a path known, whose distance along it is given."""
        self._put(_Point(road_id, along_m, lat_deg, lon_deg, heading_deg, False, ROAD_WITHIN_M))

    def near(self, sight: Sight) -> Sequence[Candidate]:
        """Every road point near a place, a road several times where it is near twice.

        None of a vehicle whose course is not known.
        """
        if sight.course_deg is None:
            return []
        row = math.floor(sight.lat_deg / CELL_DEG)
        north_m_per_deg, east_m_per_deg = self._scales(row)
        found = []
        for cell in self._around(row, sight.lon_deg):
            for point in self._cells.get(cell, ()):
                east_m = wrap_180(sight.lon_deg - point.lon_deg) * east_m_per_deg
                north_m = (sight.lat_deg - point.lat_deg) * north_m_per_deg
                candidate = _candidate(point, east_m, north_m, sight.course_deg)
                if candidate is not None:
                    found.append(candidate)
        return found

    def first(self, candidates: Sequence[Candidate]) -> Sequence[First]:
        """Where they are; nothing speaks against any."""
        return [First(candidate.along_m) for candidate in candidates]

    def advance_m(self, earlier: Candidate, later: Candidate, about_m: float) -> float | None:
        """Along one road in one direction; on a loop by its seam where that is nearer."""
        if (earlier.edge_id, earlier.direction) != (later.edge_id, later.direction):
            return None
        advance_m = (later.along_m - earlier.along_m) * later.direction
        road = self._roads.get(later.edge_id)
        if road is not None and road.loop:
            length_m = road.line.length_m
            advance_m += length_m * round((about_m - advance_m) / length_m)
        return advance_m

    def _put(self, point: _Point) -> None:
        row = math.floor(point.lat_deg / CELL_DEG)
        cell = row, self._column(row, point.lon_deg)
        self._cells[cell] = (*self._cells.get(cell, ()), point)

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


def _candidate(point: _Point, east_m: float, north_m: float, course_deg: float) -> Candidate | None:
    if abs(east_m) > ROUTE_WITHIN_M + SPACING_M or abs(north_m) > ROUTE_WITHIN_M + SPACING_M:
        return None
    heading_rad = math.radians(point.heading_deg)
    ahead_m = east_m * math.sin(heading_rad) + north_m * math.cos(heading_rad)
    beside_m = east_m * math.cos(heading_rad) - north_m * math.sin(heading_rad)
    if abs(ahead_m) > SPACING_M or abs(beside_m) > point.within_m:
        return None
    turn_deg = abs(wrap_180(course_deg - point.heading_deg))
    if turn_deg <= HEADING_WITHIN_DEG:
        direction, heading_deg = 1, point.heading_deg
    elif turn_deg >= 180.0 - HEADING_WITHIN_DEG and not point.one_way:
        direction, heading_deg = -1, wrap_360(point.heading_deg + 180.0)
    else:
        return None
    offset_m = math.hypot(beside_m, ahead_m)
    return Candidate(point.road_id, direction, point.along_m + ahead_m, offset_m, heading_deg)
