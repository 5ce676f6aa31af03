"""Pure: how much slower than usual a vehicle drives now.

Only driving counts: a light or a queue at a stop is over when it is over, but who has driven slowly
for minutes is in a jam or on a detour and goes on so for a while. Who is quick on a part of a leg
is not quick on the rest: the way there has lights and corners of its own.
"""

import math

HELD_S = 30.0
"""After driving for so long half of the pace is expected to last."""
REMEMBERED_S = 150.0
"""What was driven longer ago counts for little."""
MOST = 5.0
"""Times slower than usual."""
SEEN_S = 5.0
"""Between two instants farther apart nothing is known."""


class OwnPace:
    """Of one vehicle."""

    def __init__(self) -> None:
        self._seen_ns = 0
        self._driven_s = self._usual_s = 0.0

    def see(self, usual_s: float, t_ns: int, *, drives: bool) -> None:
        """Take what the way since the last instant usually takes, and whether it was driven."""
        since_s = (t_ns - self._seen_ns) * 1e-9
        self._seen_ns = t_ns
        if drives and 0.0 < since_s <= SEEN_S:
            kept = math.exp(-since_s / REMEMBERED_S)
            self._driven_s = kept * self._driven_s + since_s
            self._usual_s = kept * self._usual_s + max(usual_s, 0.0)

    @property
    def slower(self) -> float:
        """What the rest of the leg takes over what is usual."""
        if self._usual_s <= 0.0:
            return 1.0
        gone = min(max(self._driven_s / self._usual_s, 1.0), MOST)
        return 1.0 + self._driven_s / (self._driven_s + HELD_S) * (gone - 1.0)
