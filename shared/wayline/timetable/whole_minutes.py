"""Pure: what a timetable in whole minutes may have meant: most of them are rounded.

A time is off by up to half a minute either way, so that legs of one pace are told to take one
minute and two, or none at all, and stands of half a minute one and none.
"""

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]

MINUTE_S = 60.0
ROUNDED_STD_S = MINUTE_S / np.sqrt(12.0)
"""Of a time that was rounded to the minute."""
PACE_STD = 0.3
"""Of how much longer a metre takes on a leg than on the one before, in shares of the mean."""
SHORTEST_M = 50.0
ENDS_HELD = 1e6
"""What the times of the first and the last stop are worth beside one of the others."""
DWELLS_S = 10.0
"""Dwells of a minute or none that come to so much in the mean are rounded ones, not waits."""


def meant_times(
    alongs_m: Floats, arrivals_s: Floats, departures_s: Floats, waits: Flags
) -> tuple[Floats, Floats]:
    """Arrivals and departures at stops `alongs_m` from the start, told ones off by rounding only.

    All of shape (stops,), seconds; NaN is a time that is not told, and stays one. `waits` are the
    stops where vehicles wait for their time. What is not in whole minutes is as it was, and so are
    times that fall.
    """
    told = ~np.isnan(arrivals_s) & ~np.isnan(departures_s)
    times_s = np.column_stack((arrivals_s[told], departures_s[told])).ravel()
    if len(times_s) < 6 or np.any(times_s % MINUTE_S != 0.0) or np.any(np.diff(times_s) < 0.0):
        return arrivals_s, departures_s
    dwells_s = departures_s[told] - arrivals_s[told]
    meant_s = _meant_dwells(dwells_s, waits[told])
    waited_s = np.cumsum(np.where(meant_s == dwells_s, dwells_s, 0.0))
    driven_s = _evened(departures_s[told] - waited_s, alongs_m[told])
    departures_s, arrivals_s = departures_s.copy(), arrivals_s.copy()
    departures_s[told] = driven_s + waited_s
    arrivals_s[told] = departures_s[told] - meant_s
    return arrivals_s, departures_s


def _meant_dwells(dwells_s: Floats, waits: Flags) -> Floats:
    """Dwells of up to a minute on the way, each as long as they are in the mean."""
    rounded = ~waits & (dwells_s <= MINUTE_S)
    rounded[[0, -1]] = False
    mean_s = float(np.mean(dwells_s[rounded])) if np.any(rounded) else 0.0
    return np.where(rounded, mean_s, dwells_s) if mean_s >= DWELLS_S else dwells_s


def _evened(times_s: Floats, places_m: Floats) -> Floats:
    """Rising times at most half a minute off, at a pace that changes little from leg to leg.

    The least squares of what was rounded and of the changes of pace, in shares of their stds (the
    smoother of Whittaker 1923). The trip takes as long as told.
    """
    legs = len(times_s) - 1
    lengths_m = np.maximum(np.diff(places_m), SHORTEST_M)
    pace = max(float(times_s[-1] - times_s[0]), MINUTE_S) / float(lengths_m.sum())
    paces = np.diff(np.eye(legs + 1), axis=0) / (lengths_m[:, None] * pace * PACE_STD)
    changes = np.diff(paces, axis=0) * ROUNDED_STD_S
    held = np.ones(legs + 1)
    held[[0, -1]] = ENDS_HELD
    evened_s = np.linalg.solve(np.diag(held) + changes.T @ changes, held * times_s)
    off_s = np.clip(evened_s - times_s, -0.5 * MINUTE_S, 0.5 * MINUTE_S)
    return np.asarray(np.maximum.accumulate(times_s + off_s))
