"""Pure: how far a vehicle has come on a trip, by its wheels and fixes (`wayline.trip_distance`).

A trip may last a day, so it is summed up in stretches; fixes are kept of the last one alone.
"""

import math

from wayline.geo import step_between
from wayline.messages import GpsFix, Pose
from wayline.trip_distance.trip import TripMeter
from wayline.trip_distance.trust import HOLE_S
from wayline_history.samples import Sample

STRETCH_FIXES = 600
"""Of a stretch at least; it ends where fixes come one after the other."""
STEADY_FIXES = 10
COUNT_SCALE_STD = 0.005
"""Of the way that fusion counts: how well it knows wheels or receivers."""


class Travelled:
    """Adds up the way of one trip, by the fixes of one receiver and by poses, as they come."""

    def __init__(self) -> None:
        self._meter = TripMeter()
        self._counted = Counted()
        self._before_m = self._before_std_m = 0.0
        """Of the stretches before; what they are off by they have in common."""
        self._source: str | None = None
        self._fix_ns: int | None = None
        self._pose: Pose | None = None
        self._fixes = self._steady_fixes = 0

    def fix(self, fix: GpsFix, source: str) -> None:
        """A fix as it was received; of several receivers the first one counts."""
        self._source = self._source or source
        if source != self._source:
            return
        apart_ns = None if self._fix_ns is None else fix.t_ns - self._fix_ns
        is_steady = apart_ns is not None and 0 < apart_ns <= HOLE_S * 1e9
        self._steady_fixes = self._steady_fixes + 1 if is_steady else 0
        self._fix_ns, self._fixes = fix.t_ns, self._fixes + 1
        self._meter.take(fix)
        if self._fixes >= STRETCH_FIXES and self._steady_fixes >= STEADY_FIXES:
            self._begin_stretch(fix)

    def pose(self, sample: Sample) -> None:
        """Where the vehicle is, and how far fusion has counted."""
        self._counted.take(sample)
        counted_m, _ = self._counted.known
        self._pose = Pose(t_ns=sample.t_ns, mode=sample.mode, distance_m=counted_m)
        self._meter.take(self._pose)

    @property
    def known(self) -> tuple[float, float]:
        """Metres so far and their std."""
        found = self._meter.distance()
        if found is not None:
            return self._before_m + found.distance_m, self._before_std_m + found.distance_std_m
        return (self._before_m, self._before_std_m) if self._before_m else self._counted.known

    def _begin_stretch(self, fix: GpsFix) -> None:
        self._before_m, self._before_std_m = self.known
        self._meter, self._fixes = TripMeter(), 1
        if self._pose is not None:
            self._meter.take(self._pose)
        self._meter.take(fix)


class Counted:
    """The way that fusion counts, for a trip that neither fixes nor wheels tell of."""

    def __init__(self) -> None:
        self._last: Sample | None = None
        self._distance_m = 0.0
        self._variance_m2 = 0.0
        """Of what each step was off by, for itself."""

    def take(self, sample: Sample) -> None:
        """The way to a later pose."""
        before, self._last = self._last, sample
        if before is None:
            return
        way_m = sample.distance_m - before.distance_m
        if way_m < 0.0:
            # fusion was started anew in between and counts from there
            ends_deg = before.lat_deg, before.lon_deg, sample.lat_deg, sample.lon_deg
            way_m = step_between(*ends_deg).distance_m
            self._variance_m2 += before.position_std_m**2 + sample.position_std_m**2
        lasted_s = (sample.t_ns - before.t_ns) * 1e-9
        self._distance_m += way_m
        self._variance_m2 += ((sample.speed_std_mps or 0.0) * lasted_s) ** 2

    @property
    def known(self) -> tuple[float, float]:
        """Metres so far and their std."""
        std_m = math.hypot(math.sqrt(self._variance_m2), COUNT_SCALE_STD * self._distance_m)
        return self._distance_m, std_m
