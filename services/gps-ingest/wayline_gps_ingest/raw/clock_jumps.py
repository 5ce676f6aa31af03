"""Pure: notices where a receiver has set its clock by whole milliseconds.

Cheap receivers let their clock run until it is a millisecond off, then set it: every pseudorange
leaps by a light millisecond at once, which no motion does.
"""

from statistics import median

from wayline.messages import RawSatellite
from wayline.satellites.earth import SPEED_OF_LIGHT_MPS

LIGHT_MS_M = SPEED_OF_LIGHT_MPS * 1e-3
RATE_MAX_MPS = 2_000.0
"""Of a pseudorange between leaps: a satellite's 1,000 m/s and the drift of a poor clock."""
BETWEEN_MAX_NS = 10_000_000_000
"""Over a longer time a leap cannot be told from what moved."""

Signal = tuple[str, int, float | None]


class ClockJumps:
    """Compares each epoch's pseudoranges with those of the epoch before."""

    def __init__(self) -> None:
        self._t_ns: int | None = None
        self._pseudoranges_m: dict[Signal, float] = {}

    def leapt_ms(self, t_ns: int, satellites: tuple[RawSatellite, ...]) -> int:
        """Whole milliseconds by which all pseudoranges have leapt since the last epoch, else 0."""
        told_m = {
            (each.system, each.prn, each.carrier_hz): each.pseudorange_m
            for each in satellites
            if each.pseudorange_m is not None
        }
        last_ns, last_m = self._t_ns, self._pseudoranges_m
        self._t_ns, self._pseudoranges_m = t_ns, told_m
        shared = told_m.keys() & last_m.keys()
        if last_ns is None or not shared or not 0 < t_ns - last_ns <= BETWEEN_MAX_NS:
            return 0
        change_m = median(told_m[signal] - last_m[signal] for signal in shared)
        leapt_ms = round(change_m / LIGHT_MS_M)
        rest_m = abs(change_m - leapt_ms * LIGHT_MS_M)
        return leapt_ms if rest_m <= RATE_MAX_MPS * (t_ns - last_ns) * 1e-9 else 0
