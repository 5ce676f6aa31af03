"""Pure: how far the wheels rolled, by odometer or by what fusion counts of it."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from wayline.messages import Odometer, Pose
from wayline.trip_distance.integrated_walk import Flags, Floats

SILENCE_NS = 3_000_000_000
"""Beyond it wheels say nothing of the time between."""
KEPT_NS = 500_000_000
"""Of more frequent readings a few are kept: a trip may last a day."""


class Steps(NamedTuple):
    """Between n instants, shape (n - 1,)."""

    ways_m: Floats
    """As far as wheels told it."""
    told: Flags
    """Whether they told all of it."""


class Wheels:
    """The way by one source of wheels, added up as it comes, before any scale."""

    def __init__(self) -> None:
        self._last_ns = 0
        self._last: Odometer | Pose | None = None
        self._silences = 0
        self._kept: list[tuple[int, float, int]] = []
        """Instant, way up to then, silences up to then."""
        self.driven_m = 0.0

    @property
    def are_told(self) -> bool:
        """Whether wheels told a way of some time."""
        return len(self._kept) > 1

    def take(self, message: Odometer | Pose) -> None:
        """A speed, or a distance that was counted where no speed is told.

        What comes late is left out.
        """
        last, elapsed_ns = self._last, message.t_ns - self._last_ns
        if elapsed_ns <= 0 or (_speed_mps(message) is None and _speed_mps(last) is not None):
            return
        is_silent = last is None or elapsed_ns > SILENCE_NS
        if last is not None and not is_silent:
            self.driven_m += _step_m(last, message, elapsed_ns * 1e-9)
        if is_silent and last is not None:
            self._silences += 1
        self._last, self._last_ns = message, message.t_ns
        if is_silent or message.t_ns - self._kept[-1][0] >= KEPT_NS:
            self._kept.append((message.t_ns, self.driven_m, self._silences))

    def steps(self, times_ns: Sequence[int]) -> Steps:
        """What wheels say of the ways between instants that increase; needs `are_told`."""
        origin_ns = self._kept[0][0]
        rows = [*self._kept, (self._last_ns + 1, self.driven_m, self._silences)]
        kept_s = np.array([(t_ns - origin_ns) * 1e-9 for t_ns, _, _ in rows])
        asked_s = np.array([(t_ns - origin_ns) * 1e-9 for t_ns in times_ns])
        places = np.searchsorted(kept_s, asked_s, side="right") - 1
        silences = np.array([silences for _, _, silences in rows])[np.maximum(places, 0)]
        inside = (asked_s[:-1] >= 0.0) & (asked_s[1:] <= kept_s[-1])
        ways_m = np.interp(asked_s, kept_s, [way_m for _, way_m, _ in rows])
        return Steps(np.diff(ways_m), inside & (np.diff(silences) == 0))


def _step_m(last: Odometer | Pose, message: Odometer | Pose, elapsed_s: float) -> float:
    """By speeds, where both have one; else by distances that were counted."""
    before_mps, now_mps = _speed_mps(last), _speed_mps(message)
    if before_mps is not None and now_mps is not None:
        return 0.5 * (before_mps + now_mps) * elapsed_s
    if last.distance_m is not None and message.distance_m is not None:
        return abs(message.distance_m - last.distance_m)
    return 0.0


def _speed_mps(message: Odometer | Pose | None) -> float | None:
    """Of the wheels; a pose's speed is fusion's, which counts them itself."""
    return message.speed_mps if isinstance(message, Odometer) else None
