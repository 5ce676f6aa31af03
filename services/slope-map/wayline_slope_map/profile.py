"""Pure: what is known of a road, and the look-ahead from a position on it."""

from collections.abc import Mapping
from dataclasses import dataclass

from wayline.messages import HorizonPoint
from wayline_slope_map.roads import Road
from wayline_slope_map.sums import BinEstimate


@dataclass(frozen=True)
class RoadProfile:
    """A road and its fused bins: by direction (1 or -1), then by index along the stored line."""

    road: Road
    bins: Mapping[int, Mapping[int, BinEstimate]]


def lookahead(
    profile: RoadProfile, position_m: float, direction: int, *, length_m: float, step_m: float
) -> tuple[HorizonPoint, ...]:
    """Points every `step_m` from 0 to `length_m` ahead of a position along the road's line.

    A point says what its bin says. Beyond the road's end nothing is known, unless it is a loop.
    """
    road, bins = profile.road, profile.bins.get(direction, {})
    points = []
    for count in range(int(length_m / step_m + 1e-9) + 1):
        ahead_m = count * step_m
        along_m = position_m + direction * ahead_m
        if road.loop:
            along_m %= road.line.length_m
        points.append(_point(ahead_m, bins.get(road.bin_at(along_m))))
    return tuple(points)


def _point(distance_m: float, known: BinEstimate | None) -> HorizonPoint:
    if known is None:
        return HorizonPoint(distance_m=distance_m)
    return HorizonPoint(
        distance_m=distance_m,
        grade_pct=known.grade_pct,
        grade_std_pct=known.grade_std_pct,
        alt_m=known.alt_m,
        runs=known.runs,
        updated_ns=known.updated_ns,
    )
