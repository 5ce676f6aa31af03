"""Pure: what a pseudorange is worth, and what one that is too long still counts for."""

from typing import NamedTuple

import numpy as np

from wayline.likelihood import Floats

LOWEST_SIN = 0.12
"""Of the elevation: lower satellites are no worse than one of 7 degrees."""
STRONG_DBHZ = 45.0
"""A signal as strong comes straight; weaker ones are reflected, bent or shaded."""


class Signals(NamedTuple):
    """What tells how good ranges are, a row each; nan is what is not told."""

    claimed_m: Floats
    """Stds, as the receiver has them."""
    sines: Floats
    """Of the elevations."""
    cn0_dbhz: Floats

    def stds_m(self, floor_m: float) -> Floats:
        """Of the ranges; `floor_m` is that of a strong one from the zenith.

        Twice as much for each 12 dB that a signal is weaker.
        """
        claimed_m = np.fmax(self.claimed_m, floor_m)
        weak_db = np.fmax(STRONG_DBHZ - self.cn0_dbhz, 0.0)
        return claimed_m / np.maximum(self.sines, LOWEST_SIN) * 10.0 ** (weak_db / 40.0)


def one_sided(off: Floats, wide: float) -> Floats:
    """Weights, 0 to 1, of ranges that are longer than expected by so many stds.

    Reflections only lengthen: one too long loses its weight soon (Geman and McClure's), one too
    short later (Cauchy's).
    """
    long, short = off / (2.0 * wide), off / (3.0 * wide)
    return np.where(off > 0.0, (1.0 + long**2) ** -2, 1.0 / (1.0 + short**2))


def two_sided(off: Floats) -> Floats:
    """Weights, 0 to 1, of what is off by so many stds, to either side (Cauchy's)."""
    return 1.0 / (1.0 + (off / 3.0) ** 2)
