"""Pure: what the core and its store say to each other."""

from typing import Literal

import msgspec

from wayline.core import Record
from wayline.tuning import Tuning
from wayline_slope_map.profile import RoadProfile
from wayline_slope_map.roads import Road
from wayline_slope_map.stretches import Stretch
from wayline_slope_map.track import Track

Sensor = Literal["fused", "gps", "barometer", "torque", "vehicle"]
Direction = Literal[1, -1]
"""1 along the road's line, -1 against it."""


class RunBin(msgspec.Struct, frozen=True):
    """What one run says of one bin, by one sensor or all of them; grade in direction of travel."""

    bin_index: int
    sensor: Sensor
    grade_pct: float
    grade_std_pct: float
    alt_m: float | None
    """None where no altimeter told one."""
    alt_std_m: float | None


class DrivenRun(Record, frozen=True, kw_only=True):
    """A run has ended, over these stretches: smooth it, which takes seconds, and merge it."""

    vehicle_id: str
    track: Track
    stretches: tuple[Stretch, ...]
    tuning: Tuning


class FinishedRun(Record, frozen=True, kw_only=True):
    """A run over a stretch of a road has ended: merge it, unless it is known already."""

    vehicle_id: str
    road: Road
    direction: Direction
    start_ns: int
    end_ns: int
    bins: tuple[RunBin, ...]


class RoadLearned(msgspec.Struct, frozen=True):
    """A road as it is known after a merge, an input to the core."""

    profile: RoadProfile
