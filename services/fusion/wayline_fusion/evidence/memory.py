"""Pure: what the horizontal estimator knows besides its filter's state."""

from typing import NamedTuple

import msgspec

from wayline.geo import LocalPlane
from wayline_fusion.evidence.bias_wander import BiasWander
from wayline_fusion.evidence.lockout import CourseLockout, Lockout
from wayline_fusion.evidence.noise_scale import NoiseScale
from wayline_fusion.evidence.streak import Streak


class Rolled(NamedTuple):
    """A wheel speed, as measured, and the distance at its instant."""

    t_ns: int
    speed_mps: float
    distance_m: float


class Memory(msgspec.Struct, frozen=True):
    """All of it immutable, so that a rewind only has to take the old one back."""

    plane: LocalPlane | None = None
    heading_known: bool = False
    wheels_ns: int | None = None
    still_since_ns: int | None = None
    rolled: Rolled | None = None
    """The last wheel speed that was believed."""
    wheels_rejected: Streak | None = None
    placed_ns: int | None = None
    """When the position was last set to a fix, not corrected with one."""
    accepted_fix_ns: int | None = None
    slow_std_m: float | None = None
    """Of the fixes' slow error when that was last renewed."""
    position_unconfirmed: bool = False
    """As it was before a restart, and no fix has told since; so with the heading."""
    heading_unconfirmed: bool = False
    lockout: Lockout | None = None
    course_lockout: CourseLockout | None = None
    speed_accepted_ns: int | None = None
    speed_rejected: Streak | None = None
    still_rate_rejected: Streak | None = None
    position_noise: NoiseScale = NoiseScale()
    velocity_noise: NoiseScale = NoiseScale()
    wander: BiasWander = BiasWander()
