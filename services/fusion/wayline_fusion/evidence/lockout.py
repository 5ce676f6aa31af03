"""Pure: whether positions that the gate rejects lock the truth out, and are to be believed.

Reflections between high walls are as consistent as a true position, and so is a receiver that is
fooled for a while. What tells them apart is time: a set of walls lasts a minute or so, during
which dead reckoning is good to metres; after a long outage dead reckoning is the one to doubt.
"""

import math

import msgspec

from wayline.tuning import Tuning

AGREEING_M = 10.0
AGREEING_STDS = 4.0
"""Rejected fixes agree when they are displaced alike, to so many metres or stds."""
AGREEING_SHARE = 0.5
"""Rejected courses agree when none is off by less than this share of the one before; while the
heading is wrong and the vehicle turns they may be off by more."""
FORGOTTEN_AFTER_S = 10.0
"""A rejected fix tells nothing of one that comes so much later."""


class Lockout(msgspec.Struct, frozen=True):
    """Rejected positions that agree with each other in how far they are off."""

    since_ns: int
    last_ns: int
    east_m: float
    north_m: float
    """Fix minus prediction of the last one."""
    unaided_s: float
    """How long dead reckoning had lasted when the first was rejected."""

    @property
    def off_m(self) -> float:
        """Distance of the last one from its prediction."""
        return math.hypot(self.east_m, self.north_m)

    @property
    def agreed_s(self) -> float:
        """How long they have agreed."""
        return (self.last_ns - self.since_ns) * 1e-9


def rejected(
    before: Lockout | None, t_ns: int, off_m: tuple[float, float], std_m: float, unaided_s: float
) -> Lockout:
    """After one more rejected position, `off_m` east and north of the prediction."""
    east_m, north_m = off_m
    if before is None or t_ns - before.last_ns > FORGOTTEN_AFTER_S * 1e9:
        return Lockout(t_ns, t_ns, east_m, north_m, unaided_s)
    moved_m = math.hypot(east_m - before.east_m, north_m - before.north_m)
    is_like = moved_m <= max(AGREEING_M, AGREEING_STDS * std_m)
    since_ns = before.since_ns if is_like else t_ns
    return Lockout(since_ns, t_ns, east_m, north_m, before.unaided_s)


class CourseLockout(msgspec.Struct, frozen=True):
    """Rejected courses that agree with each other in how far they are off."""

    since_ns: int
    last_ns: int
    off_rad: float
    """Course minus heading of the last one."""

    @property
    def agreed_s(self) -> float:
        """How long they have agreed."""
        return (self.last_ns - self.since_ns) * 1e-9


def course_rejected(before: CourseLockout | None, t_ns: int, off_rad: float) -> CourseLockout:
    """After one more rejected course; noise is off to both sides, now more and now less."""
    if before is None or t_ns - before.last_ns > FORGOTTEN_AFTER_S * 1e9:
        return CourseLockout(t_ns, t_ns, off_rad)
    to_one_side = off_rad * before.off_rad > 0.0
    is_like = to_one_side and abs(off_rad) >= AGREEING_SHARE * abs(before.off_rad)
    return CourseLockout(before.since_ns if is_like else t_ns, t_ns, off_rad)


def patience_s(lockout: Lockout, supported_s: float, tuning: Tuning, *, is_likely: bool) -> float:
    """How long positions must agree before they are believed.

    `supported_s` is how long the accepted positions had agreed; `is_likely` says that these pass
    the gate, though not the one after an outage.
    """
    if lockout.unaided_s <= tuning.relock_outage_s:
        most_s = tuning.relock_after_s
    else:
        most_s = tuning.relock_at_once_s if is_likely else tuning.relock_after_outage_s
    return max(min(supported_s, most_s), tuning.relock_at_once_s)
