"""Pure: how errors grow while GPS is away, over time and over the way driven."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import msgspec
import numpy as np

from wayline_evaluation.estimates import Estimates, Floats
from wayline_evaluation.pose_errors import pose_errors
from wayline_evaluation.reference import Reference
from wayline_replay.outages import Outage

EVERY_S = 1.0
EVERY_M = 20.0
STILL_THERE_SHARE = 0.75
"""Quantiles over the way end where fewer outages than this share went so far: those that did are
the fast ones, which err otherwise."""


class Growth(msgspec.Struct, frozen=True, kw_only=True):
    """Horizontal error of one filter in all outages of one duration, as lists of equal length."""

    filter: str
    duration_s: float
    count: int
    times_s: tuple[float, ...]
    """Since GPS went away."""
    p50_m: tuple[float, ...]
    p90_m: tuple[float, ...]
    distances_m: tuple[float, ...]
    """Travelled since then."""
    over_distance_p50_m: tuple[float, ...]
    over_distance_p90_m: tuple[float, ...]


@dataclass(frozen=True, slots=True)
class Drift:
    """One filter's horizontal error in one outage, every `EVERY_S` from its beginning."""

    filter: str
    duration_s: float
    distances_m: Floats
    errors_m: Floats


def drift_of(
    outage: Outage, *, name: str, drive_start_s: float, estimates: Estimates, reference: Reference
) -> Drift:
    """How the error grew; nan where the reference or the filter knows no position."""
    since_s = np.arange(0.0, outage.length_s, EVERY_S)
    instants_s = drive_start_s + outage.start_s + since_s
    there = reference.at(instants_s)
    errors_m = pose_errors(estimates.at(instants_s), there).horizontal_m
    travelled_m = there.distances_m - there.distances_m[0]
    return Drift(name, outage.length_s, travelled_m, errors_m)


def growths(drifts: Sequence[Drift]) -> Iterator[Growth]:
    """Quantiles over the outages of each filter and duration, in order of the first of each."""
    for duration_s, name in dict.fromkeys((drift.duration_s, drift.filter) for drift in drifts):
        yield _growth(
            [each for each in drifts if (each.duration_s, each.filter) == (duration_s, name)]
        )


def _growth(drifts: Sequence[Drift]) -> Growth:
    by_time = np.array([drift.errors_m for drift in drifts])
    known = ~np.isnan(by_time).all(axis=0)
    times_s = np.arange(by_time.shape[1]) * EVERY_S
    distances_m, by_distance = _over_distance(drifts)
    return Growth(
        filter=drifts[0].filter,
        duration_s=drifts[0].duration_s,
        count=len(drifts),
        times_s=tuple(times_s[known].tolist()),
        p50_m=_quantile(by_time[:, known], 50),
        p90_m=_quantile(by_time[:, known], 90),
        distances_m=tuple(distances_m.tolist()),
        over_distance_p50_m=_quantile(by_distance, 50),
        over_distance_p90_m=_quantile(by_distance, 90),
    )


def _over_distance(drifts: Sequence[Drift]) -> tuple[Floats, Floats]:
    """Distances that enough outages reached, and the error of each outage there."""
    furthest_m = max(
        (float(np.nanmax(each.distances_m, initial=0.0)) for each in drifts), default=0.0
    )
    distances_m = np.arange(0.0, furthest_m + EVERY_M, EVERY_M)
    errors_m = np.array([_at_distances(drift, distances_m) for drift in drifts])
    reached = np.mean(~np.isnan(errors_m), axis=0) >= STILL_THERE_SHARE
    return distances_m[reached], errors_m[:, reached]


def _at_distances(drift: Drift, distances_m: Floats) -> Floats:
    """Where the vehicle stood, the error when it went on."""
    known = ~(np.isnan(drift.distances_m) | np.isnan(drift.errors_m))
    if not known.any():
        return np.full(len(distances_m), np.nan)
    travelled_m = np.maximum.accumulate(drift.distances_m[known])
    last = len(travelled_m) - 1 - np.unique(travelled_m[::-1], return_index=True)[1]
    errors_m = drift.errors_m[known][last]
    return np.asarray(np.interp(distances_m, travelled_m[last], errors_m, right=np.nan))


def _quantile(errors_m: Floats, percent: float) -> tuple[float, ...]:
    return tuple(np.nanpercentile(errors_m, percent, axis=0).tolist())
