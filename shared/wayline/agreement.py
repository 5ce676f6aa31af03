"""Pure: rejected measurements that agree with each other, and may therefore be right.

What is rejected once is noise. What is rejected again and again, off by as much each time, says
that something else is wrong: reflections, another scale, a heading, or what the filter believes.
Each aid says what it takes for agreement and how long that must last; to count it is the same.
"""

import math
from collections.abc import Callable

import msgspec

FORGOTTEN_AFTER_NS = 10_000_000_000
"""A rejected measurement tells nothing of one that comes so much later."""

Off = tuple[float, ...]
"""Measured minus expected, in the measurement's own units."""


class Agreement(msgspec.Struct, frozen=True):
    """Measurements of one sensor that were rejected without a break."""

    first_ns: int
    """When the first was rejected."""
    since_ns: int
    """When the first was rejected of those that agree with each other up to the last one."""
    last_ns: int
    off: Off = ()
    """Of the last one."""

    @property
    def agreed_s(self) -> float:
        """How long they have agreed."""
        return (self.last_ns - self.since_ns) * 1e-9

    @property
    def distance(self) -> float:
        """How far off the last one was."""
        return math.hypot(*self.off)


def always(before: Off, off: Off) -> bool:
    """Any two rejected measurements agree in being rejected."""
    del before, off
    return True


def rejected(
    before: Agreement | None,
    t_ns: int,
    off: Off = (),
    are_alike: Callable[[Off, Off], bool] = always,
    forgotten_after_ns: int = FORGOTTEN_AFTER_NS,
) -> Agreement:
    """With one more rejected measurement; `are_alike` compares it with the one before."""
    if before is None or t_ns - before.last_ns > forgotten_after_ns:
        return Agreement(t_ns, t_ns, t_ns, off)
    since_ns = before.since_ns if are_alike(before.off, off) else t_ns
    return Agreement(before.first_ns, since_ns, t_ns, off)


def lasted_s(
    agreement: Agreement | None, t_ns: int, forgotten_after_ns: int = FORGOTTEN_AFTER_NS
) -> float:
    """How long every measurement has been rejected when another one comes; else 0."""
    if agreement is None or t_ns - agreement.last_ns > forgotten_after_ns:
        return 0.0
    return (t_ns - agreement.first_ns) * 1e-9
