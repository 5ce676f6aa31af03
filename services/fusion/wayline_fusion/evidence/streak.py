"""Pure: measurements of one sensor that are rejected without a break."""

import msgspec

FORGOTTEN_AFTER_NS = 10_000_000_000
"""A rejected measurement tells nothing of one that comes so much later."""


class Streak(msgspec.Struct, frozen=True):
    """From the first to the last of them."""

    since_ns: int
    last_ns: int


def lasted_s(streak: Streak | None, t_ns: int) -> float:
    """How long every measurement has been rejected when another one comes; else 0."""
    if streak is None or t_ns - streak.last_ns > FORGOTTEN_AFTER_NS:
        return 0.0
    return (t_ns - streak.since_ns) * 1e-9


def after(streak: Streak | None, t_ns: int, *, is_accepted: bool) -> Streak | None:
    """With one more measurement."""
    if is_accepted:
        return None
    if streak is None or t_ns - streak.last_ns > FORGOTTEN_AFTER_NS:
        return Streak(t_ns, t_ns)
    return Streak(streak.since_ns, t_ns)
