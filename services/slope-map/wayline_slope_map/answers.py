"""Pure: what is known of roads as the answers over HTTP and to Zenoh queries (SPEC section 5).

Unknown is null, never 0; `runs` alone is 0 where no run has been. Instants are RFC 3339 in UTC
with milliseconds.
"""

from collections.abc import Iterable, Mapping, Sequence
from typing import Literal
from urllib.parse import quote

import msgspec

from wayline.messages import HorizonPoint
from wayline.rfc3339 import rfc3339
from wayline_slope_map.matching import Match
from wayline_slope_map.profile import RoadProfile, lookahead
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
    road, bins = profile.road, profile.bins.get(DIRECTIONS[way], {})
    return ProfileAnswer(
        road_id=road.road_id,
        length_m=road.line.length_m,
        bin_m=road.bin_m,
        direction=way,
        points=_points((at_m, bins.get(road.bin_at(at_m))) for at_m in distances_m),
    )


def lookahead_answer(
    profile: RoadProfile, at: Match, *, length_m: float, step_m: float
) -> LookaheadAnswer:
    """The road ahead of a place on it, as the core's `lookahead` knows it."""
    ahead = lookahead(profile, at.along_m, at.direction, length_m=length_m, step_m=step_m)
    return LookaheadAnswer(
        road_id=at.road_id,
        position_m=at.along_m,
        direction=WAYS[at.direction],
        points=_points((point.distance_m, point) for point in ahead),
    )


def off_road(distances_m: Iterable[float]) -> LookaheadAnswer:
    """The answer for a place that is on no known road."""
    return LookaheadAnswer(
        road_id=None,
        position_m=None,
        direction=None,
        points=_points((at_m, None) for at_m in distances_m),
    )


def _points(
    known_at: Iterable[tuple[float, BinEstimate | HorizonPoint | None]],
) -> tuple[SlopePoint, ...]:
    """Each distance with what is known there."""
    # bins that one run was over last share its instant, which takes long to write
    instants: dict[int | None, str | None] = {None: None}
    points = []
    for distance_m, known in known_at:
        if known is None:
            points.append(SlopePoint(distance_m=distance_m))
            continue
        if known.updated_ns is not None and known.updated_ns not in instants:
            instants[known.updated_ns] = rfc3339(known.updated_ns)
        points.append(
            SlopePoint(
                distance_m=distance_m,
                grade_pct=known.grade_pct,
                grade_std_pct=known.grade_std_pct,
                alt_m=known.alt_m,
                runs=known.runs,
                updated=instants[known.updated_ns],
                flagged_runs=known.flagged_runs
                if isinstance(known, BinEstimate)
                else msgspec.UNSET,
            )
        )
    return tuple(points)
