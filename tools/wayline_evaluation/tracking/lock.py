"""Pure: at which C/N0 lock is lost, by simulated loops."""

from collections.abc import Sequence

import msgspec
import numpy as np

from wayline_evaluation.estimates import Floats
from wayline_evaluation.tracking.fll import ratio_hz
from wayline_evaluation.tracking.loop import Complexes, Told, frequency_errors_hz, lost

HALF = 0.5


class LockLost(msgspec.Struct, frozen=True, kw_only=True):
    """Share of runs that lost lock at each C/N0."""

    cn0_dbhz: tuple[float, ...]
    shares: tuple[float, ...]
    half_dbhz: float | None
    """Where every second run loses lock; None where the levels do not hold it."""
    half_std_db: float | None
    """One sigma of that by the number of runs, those of another loop being others."""


def lock_lost(
    told: Told, bandwidth_hz: float, levels_dbhz: Sequence[float], noise: Complexes
) -> LockLost:
    """Of all runs at each level, in ascending order."""
    cn0_hz = np.array([ratio_hz(level) for level in levels_dbhz])
    gone = lost(frequency_errors_hz(told, bandwidth_hz, cn0_hz, noise))
    shares = np.mean(gone, axis=1)
    half_dbhz, slope_per_db = _half(np.array(levels_dbhz), shares)
    std_db = None
    if slope_per_db is not None:
        std_db = float(HALF / np.sqrt(gone.shape[1]) / slope_per_db)
    return LockLost(
        cn0_dbhz=tuple(levels_dbhz),
        shares=tuple(shares.tolist()),
        half_dbhz=half_dbhz,
        half_std_db=std_db,
    )


def _half(levels_dbhz: Floats, shares: Floats) -> tuple[float | None, float | None]:
    """Level at which the share falls below one half for good, and how fast it falls there."""
    above = np.flatnonzero(shares >= HALF)
    if len(above) == 0 or above[-1] == len(shares) - 1:
        return None, None
    before = int(above[-1])
    fallen = shares[before] - shares[before + 1]
    step_db = levels_dbhz[before + 1] - levels_dbhz[before]
    level_dbhz = levels_dbhz[before] + step_db * (shares[before] - HALF) / fallen
    return float(level_dbhz), float(fallen / step_db)


def gained_db(without: LockLost, aided: LockLost) -> float | None:
    """How much weaker a signal may be; None where either level is not known."""
    if without.half_dbhz is None or aided.half_dbhz is None:
        return None
    return without.half_dbhz - aided.half_dbhz
