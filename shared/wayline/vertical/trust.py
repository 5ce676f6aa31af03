"""Pure: whether altitudes of a receiver that were rejected are to be believed after all.

Walls displace an altitude by tens of metres for as long as they stand there, and do so alike from
one fix to the next. It is the fixes' error that is doubted then: slope and barometer hold the
altitude meanwhile. What the fixes have said for long enough is believed in the end, since the
first altitude of all may have been the one that was wrong.
"""

from functools import partial

import msgspec

from wayline.agreement import Agreement, Off, rejected
from wayline.tuning import Tuning

LIKELY_PROBABILITY = 0.95
"""Beside a barometer altitudes less likely than this count for less: walls move them at once."""
PRESSURE_FACTOR_MIN = 1.0
"""Of the claimed variance of pressures: no less than steps and cabin make; wind is learned."""
TORQUE_FACTOR_MIN = 0.05
"""Of the configured variance of slopes by torque."""
MASSES = (0.3, 3.0)
"""True mass over the stated one; beyond, torque or mass are not what they are said to be."""
NO_SUCH_MASS = "the mass would be no such vehicle's"
"""Why no torque is used then."""
AGREEING_M = 10.0
AGREEING_STDS = 2.0
"""Rejected altitudes agree when they are off alike, to so many metres or stds."""


def is_believable_mass(mass: float) -> bool:
    """Whether a vehicle that is said to weigh 1 can weigh so much."""
    return MASSES[0] < mass < MASSES[1]


class AltitudeTrust(msgspec.Struct, frozen=True):
    """What earlier altitudes of one receiver have shown."""

    set_ns: int | None = None
    """When the altitude was set to one of them, not corrected with one."""
    accepted_ns: int | None = None
    agreement: Agreement | None = None
    """Of those that were rejected, in metres from the prediction."""
    slow_std_m: float | None = None
    """Of the slow error when that was last renewed."""

    def after_set(self, t_ns: int) -> "AltitudeTrust":
        """After one that set the altitude."""
        return AltitudeTrust(t_ns, t_ns, None, self.slow_std_m)

    def after_accepted(self, t_ns: int) -> "AltitudeTrust":
        """After one that was likely."""
        return AltitudeTrust(self.set_ns, t_ns, None, self.slow_std_m)

    def after_rejected(self, t_ns: int, off_m: float, std_m: float) -> "AltitudeTrust":
        """After one that was not."""
        alike = partial(_are_alike, max(AGREEING_M, AGREEING_STDS * std_m))
        agreement = rejected(self.agreement, t_ns, (off_m,), alike)
        return AltitudeTrust(self.set_ns, self.accepted_ns, agreement, self.slow_std_m)

    def is_won(self, tuning: Tuning) -> bool:
        """Whether the rejected ones have agreed for as long as the others had before them."""
        if self.agreement is None:
            return False
        supported_s = ((self.accepted_ns or 0) - (self.set_ns or 0)) * 1e-9
        patience_s = max(min(supported_s, tuning.relock_after_s), tuning.relock_at_once_s)
        return self.agreement.agreed_s >= patience_s


def _are_alike(within_m: float, before: Off, off: Off) -> bool:
    """Whether two altitudes are displaced alike."""
    return abs(off[0] - before[0]) <= within_m
