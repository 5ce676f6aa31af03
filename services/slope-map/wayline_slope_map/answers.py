"""Pure: what is known of roads as the answers over HTTP and to Zenoh queries (SPEC section 5).

Unknown is null, never 0; `runs` alone is 0 where no run has been. Instants are RFC 3339 in UTC
with milliseconds.
"""

from collections.abc import Iterable, Mapping, Sequence
from typing import Literal
from urllib.parse import quote

import msgspec
from msgspec.structs import replace

from wayline.rfc3339 import rfc3339
from wayline_slope_map.matching import Match
from wayline_slope_map.profile import RoadProfile, bins_ahead, steps_m
from wayline_slope_map.roads import Road
from wayline_slope_map.sums import BinEstimate

Way = Literal["forward", "backward"]
"""Of travel: forward is along the road's stored line."""
WAYS: Mapping[int, Way] = {1: "forward", -1: "backward"}
DIRECTIONS: Mapping[Way, int] = {"forward": 1, "backward": -1}


class SlopePoint(msgspec.Struct, frozen=True, kw_only=True):
    """Grade and altitude at a distance; the grade is positive uphill in the direction of travel."""

    distance_m: float
    grade_pct: float | None = None
    grade_std_pct: float | None = None
    alt_m: float | None = None
    runs: int = 0
    updated: str | None = None
    """When the last of the runs was driven."""
    flagged_runs: int | msgspec.UnsetType = msgspec.UNSET
    """Of a profile: runs that said something else here and do not count."""


UNKNOWN = SlopePoint(distance_m=0.0)


class WaySummary(msgspec.Struct, frozen=True, kw_only=True):
    """What is known of one direction of a road."""

    direction: Way
    known_m: float
    """Length of the bins that a run has been over."""
    runs: int
    """The most over any bin."""
    updated: str


class RoadSummary(msgspec.Struct, frozen=True, kw_only=True):
    """A road and where its profile is."""

    road_id: str
    length_m: float
    bin_m: float
    loop: bool
    is_route: bool
    """A planned route's line, driven forward only."""
    directions: tuple[WaySummary, ...]
    href: str


class RoadList(msgspec.Struct, frozen=True):
    """Every known road, by id."""

    roads: tuple[RoadSummary, ...]


class ProfileAnswer(msgspec.Struct, frozen=True, kw_only=True):
    """A road's grade; distances count from the start of its line whatever the direction."""

    road_id: str
    length_m: float
    bin_m: float
    direction: Way
    points: tuple[SlopePoint, ...]


class LookaheadAnswer(msgspec.Struct, frozen=True, kw_only=True):
    """The road ahead of a place; distances count from there. Off every road all is null."""

    road_id: str | None
    position_m: float | None
    """Along the road's line from its start."""
    direction: Way | None
    points: tuple[SlopePoint, ...]


class VehicleLookahead(LookaheadAnswer, frozen=True, kw_only=True):
    """The road ahead of a vehicle."""

    vehicle_id: str
    age_s: float
    """Of its last pose."""


def road_list(profiles: Iterable[RoadProfile]) -> RoadList:
    """What is known of roads, by id."""
    by_id = sorted(profiles, key=lambda profile: profile.road.road_id)
    return RoadList(tuple(_road_summary(profile) for profile in by_id))


def _road_summary(profile: RoadProfile) -> RoadSummary:
    road = profile.road
    return RoadSummary(
        road_id=road.road_id,
        length_m=road.line.length_m,
        bin_m=road.bin_m,
        loop=road.loop,
        is_route=road.is_route,
        directions=tuple(
            _way_summary(direction, bins, road)
            for direction, bins in sorted(profile.bins.items(), reverse=True)
            if bins
        ),
        href=f"/v1/roads/{quote(road.road_id, safe='')}/profile",
    )


def _way_summary(direction: int, bins: Mapping[int, BinEstimate], road: Road) -> WaySummary:
    return WaySummary(
        direction=WAYS[direction],
        known_m=min(len(bins) * road.bin_m, road.line.length_m),
        runs=max(known.runs for known in bins.values()),
        updated=rfc3339(max(known.updated_ns for known in bins.values())),
    )


def profile_answer(profile: RoadProfile, way: Way, distances_m: Sequence[float]) -> ProfileAnswer:
    """What is known at distances along a road's line; a point says what its bin says."""
    road, direction = profile.road, DIRECTIONS[way]
    points = (_point(profile, direction, road.bin_at(at_m)) for at_m in distances_m)
    return ProfileAnswer(
        road_id=road.road_id,
        length_m=road.line.length_m,
        bin_m=road.bin_m,
        direction=way,
        points=tuple(
            replace(point, distance_m=at_m) for at_m, point in zip(distances_m, points, strict=True)
        ),
    )


def lookahead_answer(
    profile: RoadProfile, at: Match, *, length_m: float, step_m: float
) -> LookaheadAnswer:
    """The road ahead of a place on it, as the core's `lookahead` knows it."""
    distances_m = steps_m(length_m, step_m)
    ahead = bins_ahead(profile.road, at.along_m, at.direction, distances_m)
    points = []
    for distance_m, index in zip(distances_m, ahead, strict=True):
        known = _point(profile, at.direction, index)
        points.append(
            SlopePoint(
                distance_m=distance_m,
                grade_pct=known.grade_pct,
                grade_std_pct=known.grade_std_pct,
                alt_m=known.alt_m,
                runs=known.runs,
                updated=known.updated,
            )
        )
    return LookaheadAnswer(
        road_id=at.road_id,
        position_m=round(at.along_m, 2),
        direction=WAYS[at.direction],
        points=tuple(points),
    )


def off_road(distances_m: Sequence[float]) -> LookaheadAnswer:
    """The answer for a place that is on no known road."""
    points = tuple(SlopePoint(distance_m=each) for each in distances_m)
    return LookaheadAnswer(road_id=None, position_m=None, direction=None, points=points)


def _point(profile: RoadProfile, direction: int, index: int) -> SlopePoint:
    """What is known of a bin, at no distance yet, with the digits that mean something."""
    written: SlopePoint | None = profile.written.get((direction, index))
    if written is None:
        known = profile.bins.get(direction, {}).get(index)
        if known is None:
            return UNKNOWN
        written = profile.written[direction, index] = _written(known)
    return written


def _written(known: BinEstimate) -> SlopePoint:
    return SlopePoint(
        distance_m=0.0,
        grade_pct=round(known.grade_pct, 3),
        grade_std_pct=round(known.grade_std_pct, 3),
        alt_m=None if known.alt_m is None else round(known.alt_m, 2),
        runs=known.runs,
        updated=rfc3339(known.updated_ns),
        flagged_runs=known.flagged_runs,
    )
