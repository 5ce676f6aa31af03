"""Pure: coupling at the level of measurements (papers/001, 2 b): satellites, one by one.

The loose filter with the receiver's clock, the height and an offset a system as further states.
Fixes are made of the same pseudoranges, so they only tell where no satellite does by itself.
"""

from collections.abc import Mapping

from wayline.tuning import Tuning
from wayline_fusion.aids.satellites import Satellites
from wayline_fusion.aids.unless_ranged import UnlessRanged
from wayline_fusion.architectures import loose
from wayline_fusion.filter.estimate import Aid
from wayline_fusion.filter.ranging import RangingFilter
from wayline_fusion.intake.events import (
    Event,
    Fix,
    FixInterval,
    FixSeen,
    FixTaken,
    GpsCourse,
    GpsPosition,
    GpsSpeed,
    GyroCheck,
    Ranges,
    VelocityTold,
)

OF_FIXES = frozenset(
    {
        FixInterval,
        Fix,
        GpsSpeed,
        GpsCourse,
        GyroCheck,
        VelocityTold,
        GpsPosition,
        FixSeen,
        FixTaken,
    }
)


def measurement(tuning: Tuning) -> loose.Loose:
    """The architecture of that name."""
    return loose.Loose(tuning, aids(), RangingFilter(tuning))


def aids() -> Mapping[type[Event], Aid]:
    """Fresh ones, by the event that each takes."""
    of_all = {
        event: UnlessRanged(aid) if event in OF_FIXES else aid
        for event, aid in loose.aids().items()
    }
    return {**of_all, Ranges: Satellites()}
