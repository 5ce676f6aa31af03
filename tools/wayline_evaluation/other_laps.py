"""Pure: when a vehicle comes round a loop, for who knows how long all its other laps took.

From the place where it is, the same place on every other lap, before and after: it took as long as
these did on average. Who has stood somewhere for some seconds is where they were after as many.
"""

from collections import defaultdict
from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

from wayline.messages import Progress, StopEvent
from wayline_evaluation.eta_trials import CAME

Floats = NDArray[np.float64]

SAME_M = 2.0
"""Who has moved by less stands."""


class OtherLaps:
    """Of one vehicle on one loop, from its true progress and what it did at stops."""

    def __init__(self, progress: Sequence[Progress], events: Iterable[StopEvent]) -> None:
        self._length_m = _length_m(progress)
        self._times_s = np.array([each.t_ns * 1e-9 for each in progress])
        totals_m = np.array([each.lap * self._length_m + each.distance_m for each in progress])
        self._totals_m = np.maximum.accumulate(totals_m)
        self._came_s: defaultdict[str, dict[int, float]] = defaultdict(dict)
        for event in events:
            if event.kind in CAME:
                self._came_s[event.stop_id][event.lap] = event.t_ns * 1e-9
        self._laps = int(self._totals_m[-1] // self._length_m) + 1

    def arrivals_s(self, stop_id: str, t_s: float) -> Floats:
        """When it comes next, by each other lap; in Unix seconds, empty where none tells."""
        came_s = self._came_s[stop_id]
        lap = min((lap for lap, at_s in came_s.items() if at_s > t_s), default=None)
        if lap is None:
            return np.empty(0)
        here = int(np.searchsorted(self._times_s, t_s, side="right")) - 1
        total_m = float(self._totals_m[here])
        stood_s = t_s - self._reached_s(total_m - SAME_M)
        took_s = [
            came_s[lap + other] - passed_s
            for other in range(-self._laps, self._laps + 1)
            if other and lap + other in came_s
            if (passed_s := self._passed_s(total_m + other * self._length_m, stood_s)) is not None
        ]
        return np.asarray(t_s + np.maximum(np.array(took_s), 0.0))

    def _passed_s(self, total_m: float, stood_s: float) -> float | None:
        """When it was at a place after having been there for so long, or when it left before."""
        if not self._totals_m[0] <= total_m < self._totals_m[-1]:
            return None
        left = int(np.searchsorted(self._totals_m, total_m + SAME_M))
        left_s = float(self._times_s[min(left, len(self._times_s) - 1)])
        return min(self._reached_s(total_m - SAME_M) + stood_s, left_s)

    def _reached_s(self, total_m: float) -> float:
        at = int(np.searchsorted(self._totals_m, total_m))
        return float(self._times_s[min(at, len(self._times_s) - 1)])


def _length_m(progress: Iterable[Progress]) -> float:
    """Of a lap: nobody was farther within one than just before its end."""
    return max(each.distance_m for each in progress)
