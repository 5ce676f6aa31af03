"""Pure: what the horizontal estimator knows besides its filter's state."""

import msgspec

from wayline.geo import LocalPlane
from wayline_fusion.bias_wander import BiasWander
from wayline_fusion.lockout import CourseLockout, Lockout
from wayline_fusion.noise_scale import NoiseScale


class Memory(msgspec.Struct, frozen=True):
    """All of it immutable, so that a rewind only has to take the old one back."""

    plane: LocalPlane | None = None
    heading_known: bool = False
    wheels_ns: int | None = None
    still_since_ns: int | None = None
    wheels_rejected_since_ns: int | None = None
    """First of the wheel speeds that were rejected without a break; so with those below."""
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
    speed_rejected_since_ns: int | None = None
    still_rate_rejected_since_ns: int | None = None
    position_noise: NoiseScale = NoiseScale()
    velocity_noise: NoiseScale = NoiseScale()
    wander: BiasWander = BiasWander()
