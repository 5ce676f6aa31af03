"""Pure: what is known of a road, and the look-ahead from a position on it."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any

from wayline.messages import HorizonPoint
from wayline_slope_map.roads import Road
from wayline_slope_map.sums import BinEstimate


@dataclass(frozen=True)
class RoadProfile:
    """A road and its fused bins: by direction (1 or -1), then by index along the stored line."""

    road: Road
    bins: Mapping[int, Mapping[int, BinEstimate]]
    written: dict[tuple[int, int], Any] = field(default_factory=dict, compare=False, repr=False)
    """What answers say of bins, by direction and index, as far as they were asked for."""


def lookahead(
    profile: RoadProfile, position_m: float, direction: int, *, length_m: float, step_m: float
) -> tuple[HorizonPoint, ...]:
    """Points every `step_m` from 0 to `length_m` ahead of a position along the road's line.

    A point says what its bin says. Beyond the road's end nothing is known, unless it is a loop.
    """
    distances_m, bins = steps_m(length_m, step_m), profile.bins.get(direction, {})
    indices = bins_ahead(profile.road, position_m, direction, distances_m)
    return tuple(map(_point, distances_m, map(bins.get, indices)))


@lru_cache
def steps_m(length_m: float, step_m: float) -> tuple[float, ...]:
    """Distances from 0 to a length, to the centimetre."""
    return tuple(round(count * step_m, 2) for count in range(int(length_m / step_m + 1e-9) + 1))


def bins_ahead(
    road: Road, position_m: float, direction: int, distances_m: Sequence[float]
) -> Iterator[int]:
    """The bins at distances ahead of a position along the road's line; -1 beyond its end."""
    for ahead_m in distances_m:
        along_m = position_m + direction * ahead_m
        if road.loop:
            along_m %= road.line.length_m
        yield road.bin_at(along_m)


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
