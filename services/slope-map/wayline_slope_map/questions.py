"""Pure: what may be asked of the slope map, the same over HTTP and in a Zenoh selector."""

from collections.abc import Sequence
from typing import Annotated

import msgspec
from msgspec import UNSET, Meta, UnsetType

from wayline.query_error import QueryError
from wayline_slope_map.answers import Way
from wayline_slope_map.profile import steps_m
from wayline_slope_map.roads import Road

FURTHEST_M = 1e7
"""No road is longer."""
POINTS_MAX = 100_000
"""More points than this in one answer would keep everybody else waiting."""

LatDeg = Annotated[float, Meta(ge=-90.0, le=90.0, description="Latitude of the place")]
LonDeg = Annotated[float, Meta(ge=-180.0, le=180.0, description="Longitude of the place")]
HeadingDeg = Annotated[
    float, Meta(ge=0.0, lt=360.0, description="Direction of travel, clockwise from north")
]
LengthM = Annotated[float, Meta(gt=0.0, le=20_000.0, description="How far to look ahead")]
StepM = Annotated[float, Meta(ge=1.0, le=1000.0, description="Between the points")]
FromM = Annotated[
    float,
    Meta(ge=0.0, le=FURTHEST_M, description="First distance along the road's line"),
]
ToM = Annotated[
    float,
    Meta(ge=0.0, le=FURTHEST_M, description="Last distance along the road's line"),
]


class AheadParameters(msgspec.Struct, frozen=True, kw_only=True):
    """How far ahead, and how finely."""

    length_m: LengthM = 2000.0
    step_m: StepM = 20.0

    def distances_m(self) -> Sequence[float]:
        """Distances ahead that are asked for, from 0 to the length, as `lookahead` counts them."""
        return steps_m(self.length_m, self.step_m)


class LookaheadParameters(AheadParameters, frozen=True, kw_only=True):
    """From where, and going which way."""

    lat_deg: LatDeg
    lon_deg: LonDeg
    heading_deg: HeadingDeg


class StretchParameters(msgspec.Struct, frozen=True, kw_only=True):
    """Which direction and part of a road; without a part all of it."""

    direction: Annotated[Way, Meta(description="Along the road's line, or against it")] = "forward"
    from_m: FromM | UnsetType = UNSET
    to_m: ToM | UnsetType = UNSET

    def __post_init__(self) -> None:
        if self.from_m is not UNSET and self.to_m is not UNSET and self.to_m < self.from_m:
            raise QueryError(422, "is less than from_m", parameter="to_m")

    def holds(self, distance_m: float) -> bool:
        """Whether a distance along the road lies in the part that was asked for."""
        first_m = 0.0 if self.from_m is UNSET else self.from_m
        return first_m <= distance_m and (self.to_m is UNSET or distance_m <= self.to_m)


class ProfileParameters(StretchParameters, frozen=True, kw_only=True):
    """Which points of a road.

    Without `from_m` the first is the centre of the first bin, without `step_m` they are a bin
    apart: so without both there is one point a bin, named by its centre.
    """

    step_m: StepM | UnsetType = UNSET

    def distances_m(self, road: Road) -> Sequence[float]:
        """Distances of the points along a road's line, none beyond its end.

        Raises QueryError (422) for too many of them.
        """
        first_m = 0.5 * road.bin_m if self.from_m is UNSET else self.from_m
        step_m = road.bin_m if self.step_m is UNSET else self.step_m
        length_m = road.line.length_m
        last_m = length_m if self.to_m is UNSET else min(self.to_m, length_m)
        count = max(int((last_m - first_m) / step_m + 1e-9) + 1, 0) if last_m >= first_m else 0
        if count > POINTS_MAX:
            detail = f"would make {count} points, more than {POINTS_MAX}; ask for parts"
            raise QueryError(422, detail, parameter="step_m")
        return [first_m + step_m * index for index in range(count)]
