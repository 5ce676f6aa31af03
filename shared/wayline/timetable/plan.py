"""Pure: the times of one trip made whole: travel apart from waits, every stop timed.

Timetables are written in whole minutes and by hand. A time that cannot be driven is taken as not
given and interpolated by distance; one that leaves more time than a walk needs is a wait. No time
is lost: where the feed times the last stop, its arrival is kept.
"""

import itertools
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wayline.route import DEFAULT_SPEED_MPS

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]

WALKING_MPS, FASTEST_MPS = 1.0, 40.0
"""Slower than a walk is a wait on the way; faster than this is a mistake."""
BAYS_M = 50.0
"""Two stops nearer than this are bays of one: a vehicle drives up and waits at the second."""


class Plan(NamedTuple):
    """When a trip is at its stops, in seconds; each of shape (stops,)."""

    arrivals_s: Floats
    departures_s: Floats
    untimed: Flags
    """The feed gave no time there, or none that could be driven."""
    impossible: Flags
    """The feed's time there could not be driven."""
    slow: Flags
    """The leg that leaves from there is slower than a walk: part of it is a wait."""


def make_plan(alongs_m: Floats, arrivals_s: Floats, departures_s: Floats) -> Plan:
    """Times at stops `alongs_m` from the start, from the feed's; NaN is a time it does not give."""
    given_s = np.where(np.isnan(arrivals_s), departures_s, arrivals_s)
    left_s = np.fmax(np.where(np.isnan(departures_s), given_s, departures_s), given_s)
    timed = ~np.isnan(given_s)
    kept = _drivable(alongs_m, given_s, left_s)
    arrivals_s, departures_s = _interpolated(alongs_m, given_s, left_s, kept)
    arrivals_s, departures_s, slow = _waiting(alongs_m, arrivals_s, departures_s)
    return Plan(arrivals_s, departures_s, ~kept, timed & ~kept, slow)


def _drivable(alongs_m: Floats, arrivals_s: Floats, departures_s: Floats) -> Flags:
    """Which times count: the most that rise in order, without those that nobody could keep."""
    rising = _rising(arrivals_s, departures_s)
    kept: list[int] = []
    for stop in rising:
        while kept and _too_fast(alongs_m, arrivals_s, departures_s, kept[-1], stop):
            if len(kept) == 1 or stop != rising[-1]:
                break
            kept.pop()
        if not kept or not _too_fast(alongs_m, arrivals_s, departures_s, kept[-1], stop):
            kept.append(stop)
    flags = np.zeros(len(arrivals_s), dtype=np.bool_)
    flags[kept] = True
    return flags


def _too_fast(
    alongs_m: Floats, arrivals_s: Floats, departures_s: Floats, before: int, after: int
) -> bool:
    took_s = arrivals_s[after] - departures_s[before]
    return bool(alongs_m[after] - alongs_m[before] > FASTEST_MPS * took_s)


def _rising(arrivals_s: Floats, departures_s: Floats) -> list[int]:
    """The most stops whose times follow each other (longest non-decreasing subsequence)."""
    timed = np.flatnonzero(~np.isnan(arrivals_s)).tolist()
    if all(departures_s[a] <= arrivals_s[b] for a, b in itertools.pairwise(timed)):
        return timed
    best: dict[int, tuple[int, int | None]] = {}
    for stop in timed:
        earlier = [each for each in best if departures_s[each] <= arrivals_s[stop]]
        last = max(earlier, key=lambda each: best[each][0], default=None)
        best[stop] = (best[last][0] + 1 if last is not None else 1, last)
    chain: list[int] = []
    at = max(best, key=lambda each: best[each][0], default=None)
    while at is not None:
        chain.append(at)
        at = best[at][1]
    return chain[::-1]


def _interpolated(
    alongs_m: Floats, arrivals_s: Floats, departures_s: Floats, kept: Flags
) -> tuple[Floats, Floats]:
    """Times at every stop: by distance between timed ones, at their speed before and after."""
    known = np.flatnonzero(kept)
    if not len(known):
        times_s = (alongs_m - alongs_m[0]) / DEFAULT_SPEED_MPS
        return times_s, times_s.copy()
    arrivals, departures = arrivals_s.copy(), departures_s.copy()
    speed_mps = _overall_speed(alongs_m, arrivals_s, departures_s, known)
    for stop in np.flatnonzero(~kept):
        before, after = known[known < stop], known[known > stop]
        if len(before) and len(after):
            a, b = before[-1], after[0]
            whole_m = max(alongs_m[b] - alongs_m[a], 1e-9)
            share = (alongs_m[stop] - alongs_m[a]) / whole_m
            time_s = departures_s[a] + share * (arrivals_s[b] - departures_s[a])
        elif len(before):
            a = before[-1]
            time_s = departures_s[a] + (alongs_m[stop] - alongs_m[a]) / speed_mps
        else:
            b = after[0]
            time_s = arrivals_s[b] - (alongs_m[b] - alongs_m[stop]) / speed_mps
        arrivals[stop] = departures[stop] = time_s
    return arrivals, departures


def _overall_speed(
    alongs_m: Floats, arrivals_s: Floats, departures_s: Floats, known: NDArray[np.intp]
) -> float:
    took_s = arrivals_s[known[-1]] - departures_s[known[0]]
    if took_s <= 0.0:
        return DEFAULT_SPEED_MPS
    speed_mps = (alongs_m[known[-1]] - alongs_m[known[0]]) / took_s
    return float(np.clip(speed_mps, WALKING_MPS, FASTEST_MPS))


def _waiting(
    alongs_m: Floats, arrivals_s: Floats, departures_s: Floats
) -> tuple[Floats, Floats, Flags]:
    """Waits apart from travel.

    At two bays of a stop the wait is at the second one, which the vehicle reaches with the first;
    elsewhere the vehicle leaves late, so that it arrives when the feed says.
    """
    arrivals_s, departures_s = arrivals_s.copy(), departures_s.copy()
    moved_m, took_s = np.diff(alongs_m), arrivals_s[1:] - departures_s[:-1]
    slow = took_s * WALKING_MPS > moved_m
    usual = (moved_m > 0.0) & ~slow
    cruise_mps = DEFAULT_SPEED_MPS
    if usual.any():
        cruise_mps = float(moved_m[usual].sum() / took_s[usual].sum())
    for leg in np.flatnonzero(slow):
        travel_s = moved_m[leg] / cruise_mps
        if moved_m[leg] <= BAYS_M:
            arrivals_s[leg + 1] = departures_s[leg] + travel_s
        else:
            departures_s[leg] = arrivals_s[leg + 1] - travel_s
    return arrivals_s, departures_s, np.append(slow, [False])
