"""Pure: what `wayline evaluate smoothing` found, as a program reads it."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import reduce

import msgspec
import numpy as np

from wayline_evaluation.smoothing.scores import MethodScore, Pair, TripScore
from wayline_evaluation.smoothing.smoothers import Method
from wayline_evaluation.smoothing.statistics import (
    ChiSquare,
    ErrorFigures,
    Sums,
    Tested,
    chi_square,
    figures_of_errors,
    paired_t,
    sums_of,
    trips_by_mile,
)
from wayline_evaluation.smoothing.trip import ReferenceKind


class DistanceFigures(msgspec.Struct, frozen=True, kw_only=True):
    """Distances of trips: reference minus method, metres; shares are of the reference."""

    errors_m: ErrorFigures
    error_p50_pct: float
    error_p95_pct: float
    error_max_pct: float
    in_two_std: float | None
    """Share of the trips; null of a method that tells no std."""
    against_reference: Tested
    by_mile: ChiSquare


class MethodReport(msgspec.Struct, frozen=True, kw_only=True):
    """One method over all trips on which it ran."""

    trips: int
    speed_mps: ErrorFigures | None
    bad_signal_speed_mps: ErrorFigures | None
    """At fixes of fewer than 4 satellites or a PDOP above 8."""
    acceleration_mps2: ErrorFigures | None
    distance: DistanceFigures
    """By positions; of `rts` and `fusion` by all that they have."""
    speed_distance: DistanceFigures
    """By speeds added up."""


class PairReport(msgspec.Struct, frozen=True, kw_only=True):
    """Whether two methods have the same mean error (table 2)."""

    method_a: Method
    method_b: Method
    delta_speed: Tested
    delta_acceleration: Tested


class TripReport(msgspec.Struct, frozen=True, kw_only=True):
    """One trip; metres."""

    trip: str
    reference: ReferenceKind
    reference_m: float
    fixes: int
    bad_fixes: int
    holes: int
    distance_m: dict[Method, float]
    distance_std_m: float | None
    """Of `rts`."""


class SmoothingReport(msgspec.Struct, frozen=True, kw_only=True):
    """The study over all trips."""

    trips: tuple[TripReport, ...]
    references: dict[ReferenceKind, int]
    """Trips by what they are judged by."""
    fixes: int
    bad_fixes: int
    reference_trips_by_mile: tuple[int, ...]
    methods: dict[Method, MethodReport]
    pairs: tuple[PairReport, ...]
    notes: dict[str, tuple[str, ...]]
    """What a user should know, by trip; those that were left out are among them."""


def report_of(scores: Sequence[TripScore], notes: Mapping[str, tuple[str, ...]]) -> SmoothingReport:
    """All trips together; at least one."""
    kinds = [score.reference for score in scores]
    names = list(dict.fromkeys(name for score in scores for name in score.methods))
    two = list(dict.fromkeys(pair for score in scores for pair in score.speed_pairs))
    return SmoothingReport(
        trips=tuple(map(_trip_report, scores)),
        references={kind: kinds.count(kind) for kind in dict.fromkeys(kinds)},
        fixes=sum(score.fixes for score in scores),
        bad_fixes=sum(score.bad_fixes for score in scores),
        reference_trips_by_mile=trips_by_mile([score.reference_m for score in scores]),
        methods={name: _method_report(name, scores) for name in names},
        pairs=tuple(_pair_report(pair, scores) for pair in two),
        notes=dict(notes),
    )


def _trip_report(score: TripScore) -> TripReport:
    rts = score.methods.get("rts")
    return TripReport(
        trip=score.name,
        reference=score.reference,
        reference_m=score.reference_m,
        fixes=score.fixes,
        bad_fixes=score.bad_fixes,
        holes=score.holes,
        distance_m={name: each.distance_m for name, each in score.methods.items()},
        distance_std_m=None if rts is None else rts.distance_std_m,
    )


def _method_report(name: Method, scores: Sequence[TripScore]) -> MethodReport:
    run = [score for score in scores if name in score.methods]
    there = [score.methods[name] for score in run]
    reference_m = [score.reference_m for score in run]
    stds_m = [each.distance_std_m for each in there]

    def pooled(of: Callable[[MethodScore], Sums]) -> ErrorFigures | None:
        return figures_of_errors(_together(map(of, there)))

    return MethodReport(
        trips=len(run),
        speed_mps=pooled(lambda each: each.speed),
        bad_signal_speed_mps=pooled(lambda each: each.bad_speed),
        acceleration_mps2=pooled(lambda each: each.acceleration),
        distance=_distances(reference_m, [each.distance_m for each in there], stds_m),
        speed_distance=_distances(reference_m, [each.speed_distance_m for each in there], None),
    )


def _together(sums: Iterable[Sums]) -> Sums:
    return reduce(Sums.plus, sums, Sums())


def _distances(
    reference_m: Sequence[float], method_m: Sequence[float], stds_m: Sequence[float | None] | None
) -> DistanceFigures:
    wanted_m, said_m = np.array(reference_m), np.array(method_m)
    sums = sums_of(wanted_m - said_m)
    errors_m = figures_of_errors(sums)
    if errors_m is None:
        raise ValueError("no trip has a distance")
    shares_pct = 100.0 * np.abs(said_m - wanted_m) / np.maximum(wanted_m, 1.0)
    middle, high, most = (float(share) for share in np.percentile(shares_pct, [50, 95, 100]))
    known = [std for std in stds_m or () if std is not None]
    inside = None
    if len(known) == len(said_m):
        inside = float(np.mean(np.abs(said_m - wanted_m) <= 2.0 * np.array(known)))
    return DistanceFigures(
        errors_m=errors_m,
        error_p50_pct=middle,
        error_p95_pct=high,
        error_max_pct=most,
        in_two_std=inside,
        against_reference=paired_t(sums),
        by_mile=chi_square(trips_by_mile(reference_m), trips_by_mile(method_m)),
    )


def _pair_report(pair: Pair, scores: Sequence[TripScore]) -> PairReport:
    run = [score for score in scores if pair in score.speed_pairs]
    return PairReport(
        method_a=pair[0],
        method_b=pair[1],
        delta_speed=paired_t(_together(score.speed_pairs[pair] for score in run)),
        delta_acceleration=paired_t(_together(score.acceleration_pairs[pair] for score in run)),
    )
