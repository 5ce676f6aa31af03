"""Pure: a road: the stored line that positions, bins and directions refer to."""

import hashlib
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from wayline.errors import InputError
from wayline.geo import metres_per_degree
from wayline.line import Floats, Line

LINE_TOLERANCE_M = 2.0
"""How far a stored line may run beside the driven path; receivers wander more than that."""
CLOSES_WITHIN_M = 40.0
"""A road whose end lies this near to its start, heading on into it, is a loop."""
ROUTE_TOLERANCE_M = 5.0
"""A route whose vertices lie this near to the stored line is still the same route."""


@dataclass(frozen=True)
class Road:
    """A directed line, cut into bins of `bin_m` metres from its start.

    Bin i holds the distances from i to i + 1 times `bin_m` and is named by its centre.
    A route's road is driven in its own direction only.
    """

    road_id: str
    bin_m: float
    loop: bool
    is_route: bool
    points: tuple[tuple[float, float], ...]
    """Latitude and longitude in degrees."""

    @cached_property
    def line(self) -> Line:
        """The line to measure along."""
        return Line(*np.array(self.points, dtype=np.float64).T)

    @cached_property
    def bins(self) -> int:
        """Bins whose centre lies on the line."""
        return int(self.line.length_m / self.bin_m + 0.5)

    def bin_at(self, distance_m: float) -> int:
        """The bin of a distance along the line; a rest shorter than half a bin is the last bin's.

        Beyond the line it is a bin that does not exist.
        """
        if 0.0 <= distance_m <= self.line.length_m:
            return min(int(distance_m // self.bin_m), self.bins - 1)
        return -1

    def centre_m(self, bin_index: int) -> float:
        """Distance along the line of a bin's centre."""
        return (bin_index + 0.5) * self.bin_m


def route_road(line: Line, route_id: str, *, loop: bool, bin_m: float) -> Road:
    """The road that a route is."""
    points = tuple(zip(line.lats_deg.tolist(), line.lons_deg.tolist(), strict=True))
    return Road(route_id, bin_m, loop, is_route=True, points=points)


def check_same_route(stored: Road, route: Road) -> None:
    """Raise InputError if a route's line has moved since its slope was learned.

    The bins are distances along the line, so they would describe other places.
    """
    apart_m = [
        abs(nearest.cross_track_m)
        for lat_deg, lon_deg in route.points
        if (nearest := stored.line.project(lat_deg, lon_deg)) is not None
    ]
    longer_m = abs(stored.line.length_m - route.line.length_m)
    if max(apart_m) > ROUTE_TOLERANCE_M or longer_m > stored.bin_m:
        raise InputError(
            f"route {route.road_id}",
            "its line is not the one whose slope was learned",
            "give the changed route another route_id, or use another database",
        )


def made_road(lats_deg: Floats, lons_deg: Floats, *, bin_m: float) -> tuple[Road, list[int]]:
    """A road along a driven path, and the indices of the path's points that its line keeps.

    Its id follows from its geometry alone, so that the same input gives the same road.
    """
    kept = simplified(lats_deg, lons_deg, LINE_TOLERANCE_M)
    points = tuple((round(float(lats_deg[i]), 7), round(float(lons_deg[i]), 7)) for i in kept)
    digest = hashlib.blake2s(repr(points).encode(), digest_size=6).hexdigest()
    line = Line(*np.array(points).T)
    road = Road(f"road-{digest}", bin_m, _closes(line), is_route=False, points=points)
    return road, kept


def _closes(line: Line) -> bool:
    end_lat_deg, end_lon_deg, end_heading_deg = line.point_at(line.length_m)
    start = line.project(
        end_lat_deg,
        end_lon_deg,
        to_m=min(2.0 * CLOSES_WITHIN_M, 0.5 * line.length_m),
        heading_deg=end_heading_deg,
        heading_tolerance_deg=60.0,
    )
    return start is not None and abs(start.cross_track_m) <= CLOSES_WITHIN_M


def simplified(lats_deg: Floats, lons_deg: Floats, tolerance_m: float) -> list[int]:
    """Indices of the points to keep so that no other lies further from the line (Douglas-Peucker).

    Shape (n,) each, n >= 2; first and last are kept.
    """
    north_m_per_deg, east_m_per_deg = metres_per_degree(float(np.mean(lats_deg)))
    east_m = (lons_deg - lons_deg[0] + 180.0) % 360.0 * east_m_per_deg
    north_m = lats_deg * north_m_per_deg
    kept = {0, len(lats_deg) - 1}
    open_spans = [(0, len(lats_deg) - 1)]
    while open_spans:
        first, last = open_spans.pop()
        if last - first < 2:
            continue
        away_m = _distances_m(east_m[first : last + 1], north_m[first : last + 1])
        furthest = first + int(np.argmax(away_m))
        if away_m[furthest - first] > tolerance_m:
            kept.add(furthest)
            open_spans += [(first, furthest), (furthest, last)]
    return sorted(kept)


def _distances_m(east_m: Floats, north_m: Floats) -> Floats:
    """Of every point from the segment between the first and the last."""
    east, north = east_m - east_m[0], north_m - north_m[0]
    squared = max(float(east[-1] ** 2 + north[-1] ** 2), 1e-12)
    share = np.clip((east * east[-1] + north * north[-1]) / squared, 0.0, 1.0)
    away: Floats = np.hypot(east - share * east[-1], north - share * north[-1])
    return away
