"""Pure: what a pseudorange is worth, and what one that is too long still counts for."""

import numpy as np

from wayline.likelihood import Floats

LOWEST_SIN = 0.12
"""Of the elevation: beneath it the air is no thicker to any use."""
STRONG_DBHZ = 45.0
"""A signal as strong comes straight; weaker ones are reflected, bent or shaded."""
FLOOR_M = 3.0


def range_stds_m(claimed_m: Floats, sines: Floats, cn0_dbhz: Floats) -> Floats:
    """By what the receiver claims, the sine of the elevation and the signal's strength."""
    claimed_m = np.where(np.isnan(claimed_m), FLOOR_M, np.maximum(claimed_m, FLOOR_M))
    weak_db = np.where(np.isnan(cn0_dbhz), 0.0, np.maximum(STRONG_DBHZ - cn0_dbhz, 0.0))
    return claimed_m / np.maximum(sines, LOWEST_SIN) * 10.0 ** (weak_db / 40.0)


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
