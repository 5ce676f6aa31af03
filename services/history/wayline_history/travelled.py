"""Pure: how far a vehicle has come on a trip, by the way that fusion counts, with its std."""

import math
from dataclasses import dataclass

from wayline.geo import step_between
from wayline_history.samples import Sample

SCALE_STD = 0.005
"""Of the way that fusion counts: how well wheels or receivers are calibrated."""


@dataclass(slots=True)
class Travelled:
    """Adds up the ways between poses."""

    distance_m: float = 0.0
    _variance_m2: float = 0.0
    """Of what each way was off by, for itself."""

    def add(self, before: Sample, sample: Sample) -> None:
        """The way from one pose to a later one."""
        way_m = sample.distance_m - before.distance_m
        if way_m < 0.0:
            # fusion was started anew in between and counts from there
            way_m = step_between(
                before.lat_deg, before.lon_deg, sample.lat_deg, sample.lon_deg
            ).distance_m
            self._variance_m2 += before.position_std_m**2 + sample.position_std_m**2
        lasted_s = (sample.t_ns - before.t_ns) * 1e-9
        self.distance_m += way_m
        self._variance_m2 += ((sample.speed_std_mps or 0.0) * lasted_s) ** 2

    @property
    def known(self) -> tuple[float, float]:
        """Metres so far and their std."""
        return self.distance_m, math.hypot(
            math.sqrt(self._variance_m2), SCALE_STD * self.distance_m
        )
