"""Pure: where the antenna was and how it moved at an instant of the last seconds."""

from collections import deque

from wayline.satellites.doppler import Antenna

KEPT = 30
"""Of ten a second: an epoch that comes later tells nothing."""


class Past:
    """The antenna of the last ticks, in order."""

    def __init__(self) -> None:
        self._ticks: deque[tuple[int, Antenna]] = deque(maxlen=KEPT)

    def add(self, t_ns: int, antenna: Antenna) -> None:
        """Where it is now; a time that does not follow begins anew."""
        if self._ticks and t_ns <= self._ticks[-1][0]:
            self._ticks.clear()
        self._ticks.append((t_ns, antenna))

    def at(self, t_ns: int) -> Antenna | None:
        """Between two ticks; None before the first and after the last."""
        ticks = self._ticks
        for later in range(len(ticks) - 1, -1, -1):
            then_ns, antenna = ticks[later]
            if then_ns == t_ns:
                return antenna
            if then_ns < t_ns:
                return (
                    None
                    if later == len(ticks) - 1
                    else _between(*ticks[later], *ticks[later + 1], t_ns)
                )
        return None


def _between(before_ns: int, before: Antenna, after_ns: int, after: Antenna, t_ns: int) -> Antenna:
    share = (t_ns - before_ns) / (after_ns - before_ns)
    return after._replace(
        place_m=before.place_m + share * (after.place_m - before.place_m),
        velocity_mps=before.velocity_mps + share * (after.velocity_mps - before.velocity_mps),
    )
