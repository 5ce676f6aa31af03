"""Pure: whether a vehicle may carry another load than a while ago.

Nobody is loaded while driving. After a stand of minutes the mass is doubted; if it is the same,
some hundred metres tell so.
"""

import msgspec

STOOD_S = 120.0
"""Without any torque for so long the vehicle may have been loaded."""
DOUBT_STD_SHARE = 0.6
"""Of the inverse mass then, over the stated one's: a truck weighs 15 t empty and 40 t full."""
DOUBT_SLOPE_STD = 0.03
"""Of the slope then, a tangent: a valley may lie where the vehicle braked, and the same torques
tell of mass and slope."""


class Loading(msgspec.Struct, frozen=True):
    """When torque told of the mass last."""

    told_ns: int | None = None

    def is_doubted(self, t_ns: int) -> bool:
        """Whether a torque at an instant is the first after a stand."""
        return self.told_ns is not None and t_ns - self.told_ns >= STOOD_S * 1e9
