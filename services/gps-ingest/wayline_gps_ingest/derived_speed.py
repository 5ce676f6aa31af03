"""Pure: the speed of a receiver that tells none, from where it was before."""

import msgspec

from wayline.geo import step_between
from wayline.messages import SPEED_MAX_MPS, GpsFix

APART_MAX_NS = 10_000_000_000
"""The mean speed over a longer gap is no longer the speed of now."""


class DerivedSpeed:
    """Fills in the speed of fixes whose receiver tells none, and marks it as derived."""

    def __init__(self) -> None:
        self._last: GpsFix | None = None

    def filled(self, fix: GpsFix) -> GpsFix:
        """A valid fix, with the speed over the ground since the one before where it has none."""
        last, self._last = self._last, fix
        if last is None or fix.speed_mps is not None:
            return fix
        speed_mps = _speed_mps(last, fix)
        if speed_mps is None:
            return fix
        return msgspec.structs.replace(fix, speed_mps=speed_mps, speed_derived=True)


def _speed_mps(last: GpsFix, fix: GpsFix) -> float | None:
    apart_ns = fix.t_ns - last.t_ns
    if not 0 < apart_ns <= APART_MAX_NS:
        return None
    if last.lat_deg is None or last.lon_deg is None or fix.lat_deg is None or fix.lon_deg is None:
        return None
    step = step_between(last.lat_deg, last.lon_deg, fix.lat_deg, fix.lon_deg)
    speed_mps = step.distance_m / (apart_ns * 1e-9)
    return speed_mps if speed_mps <= SPEED_MAX_MPS else None
