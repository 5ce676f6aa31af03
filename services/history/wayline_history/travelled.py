"""Pure: how far a vehicle has come on a trip, with its std, from fixes and the wheels in poses.

The distance of a stretch is `wayline.trip_distance`'s: wheels that fixes measure, else smoothed
speeds of fixes. A trip is measured in stretches of five minutes, so that a day of driving is not
held. Where neither tells (a pose a minute, no fix), fusion's own distance stands.
"""

import math
from collections import Counter
from typing import NamedTuple

from wayline.geo import step_between
from wayline.messages import GpsFix, Pose
from wayline.trip_distance.trip import SPEED_SCALE_STD, TripMeter
from wayline_history.samples import Sample

STRETCH_NS = 300_000_000_000
LATE_NS = 5_000_000_000
"""Fixes of a stretch have come so long after its end."""
COUNTED_SCALE_STD = 0.02
"""Of the way that fusion counts, where no fix measures it."""


class SourcedFix(NamedTuple):
    """A fix and its receiver."""

    source: str
    fix: GpsFix


class Way(NamedTuple):
    """How far, and one sigma of it."""

    distance_m: float
    std_m: float


class Travelled:
    """Measures a trip that began at an instant; poses come in order of time, fixes as they do."""

    def __init__(self, start: Sample, fixes: list[SourcedFix]) -> None:
        self._behind = Way(0.0, 0.0)
        """Of the stretches that are measured."""
        self._anew_m = 0.0
        """To be added to what fusion counts since it was started anew on the way."""
        self._samples = [start]
        self._fixes = [each for each in fixes if each.fix.t_ns >= start.t_ns]

    def fix(self, sourced: SourcedFix) -> None:
        """A fix, early or late."""
        self._fixes.append(sourced)

    def pose(self, sample: Sample) -> None:
        """A pose of the trip, or of the stand that may be its end."""
        before, counted_m = self._samples[-1], sample.distance_m + self._anew_m
        if counted_m < before.distance_m:
            counted_m = before.distance_m + _apart_m(before, sample)
            self._anew_m = counted_m - sample.distance_m
        self._samples.append(sample._replace(distance_m=counted_m))

    def measure(self, until_ns: int) -> None:
        """Measure stretches that are over, of a trip that goes on at an instant."""
        first_ns = self._samples[0].t_ns
        if until_ns - first_ns < STRETCH_NS + LATE_NS:
            return
        end_ns = first_ns + STRETCH_NS
        self._behind = self.way_to(end_ns)
        self._samples = self._after(end_ns)
        last_ns = max((each.fix.t_ns for each in self._before(end_ns)), default=end_ns)
        # the last fix before is the next stretch's first
        self._fixes = [each for each in self._fixes if each.fix.t_ns >= last_ns]

    def way_to(self, end_ns: int) -> Way:
        """The trip up to an instant that is not measured yet."""
        samples = [each for each in self._samples if each.t_ns <= end_ns]
        stretch = _measured(samples, self._before(end_ns)) or _counted(samples)
        return Way(
            self._behind.distance_m + stretch.distance_m,
            math.hypot(self._behind.std_m, stretch.std_m),
        )

    def _before(self, end_ns: int) -> list[SourcedFix]:
        return [each for each in self._fixes if each.fix.t_ns <= end_ns]

    def _after(self, end_ns: int) -> list[Sample]:
        """The poses of the next stretch, which begins with the last one of this."""
        inside = sum(each.t_ns <= end_ns for each in self._samples)
        return self._samples[inside - 1 :]


def honest(way: Way) -> Way:
    """With what all stretches are off by alike."""
    return Way(way.distance_m, math.hypot(way.std_m, SPEED_SCALE_STD * way.distance_m))


def _measured(samples: list[Sample], fixes: list[SourcedFix]) -> Way | None:
    """By the receiver that told most, and the wheels; None where they do not tell."""
    meter = TripMeter()
    told = Counter(each.source for each in fixes)
    most = min(told, key=lambda source: (-told[source], source), default="")
    for fix in sorted((e.fix for e in fixes if e.source == most), key=lambda fix: fix.t_ns):
        meter.take(fix)
    for sample in samples:
        meter.take(_pose(sample))
    found = meter.distance()
    return None if found is None else Way(found.distance_m, found.distance_std_m)


def _pose(sample: Sample) -> Pose:
    return Pose(
        t_ns=sample.t_ns,
        mode=sample.mode,
        speed_mps=sample.speed_mps,
        distance_m=sample.distance_m,
    )


def _counted(samples: list[Sample]) -> Way:
    """As fusion counts."""
    distance_m = samples[-1].distance_m - samples[0].distance_m
    return Way(distance_m, COUNTED_SCALE_STD * distance_m)


def _apart_m(one: Sample, other: Sample) -> float:
    places = one.lat_deg, one.lon_deg, other.lat_deg, other.lon_deg
    return step_between(*places).distance_m
