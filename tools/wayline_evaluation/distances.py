"""Pure: distances of trips as Wayline measures them, and by GPS alone beside a reference."""

from collections.abc import Sequence

import msgspec
import numpy as np

from wayline.line import Line
from wayline.messages import GpsFix, Odometer
from wayline.trip_distance.trip import DistanceBasis, TripMeter
from wayline.tuning import Tuning
from wayline_evaluation.smoothing.trip import Reference, ReferenceKind


class Measured(msgspec.Struct, frozen=True, kw_only=True):
    """One sigma of the total error beside each distance."""

    distance_m: float
    distance_std_m: float
    basis: DistanceBasis
    bridged_m: float
    """In holes of GPS that nothing else told."""


class DriveDistance(msgspec.Struct, frozen=True, kw_only=True):
    """A drive as one trip."""

    drive: str
    measured: Measured
    """By all that there is."""
    by_gps: Measured | None
    """By GPS alone, from the first fix to the last."""
    reference: ReferenceKind | None
    """`wheels` have the scale that GPS tells; null where the receiver's speeds are doubted."""
    reference_m: float | None
    """From the first fix to the last."""
    error_pct: float | None
    """Of GPS alone against the reference."""
    stds: float | None
    """The same in its stds."""
    notes: tuple[str, ...]


class DistanceReport(msgspec.Struct, frozen=True, kw_only=True):
    """All drives, and what their errors by GPS alone are, without sign; null without a reference"""

    drives: tuple[DriveDistance, ...]
    error_p50_pct: float | None
    error_mean_pct: float | None
    error_p95_pct: float | None
    error_max_pct: float | None
    in_two_std: float | None
    """Share of the drives; 0.954 where stds are honest."""


def measured_trip(
    fixes: Sequence[GpsFix], wheels: Sequence[Odometer], tuning: Tuning, route: Line | None
) -> tuple[Measured | None, tuple[str, ...]]:
    """How far a trip went, and what is to be doubted; None where nothing tells."""
    meter = TripMeter(tuning, route)
    messages: list[GpsFix | Odometer] = [*fixes, *wheels]
    for message in sorted(messages, key=lambda each: each.t_ns):
        meter.take(message)
    found = meter.distance()
    if found is None:
        return None, ()
    measured = Measured(
        distance_m=found.distance_m,
        distance_std_m=found.distance_std_m,
        basis=found.basis,
        bridged_m=found.bridged_m,
    )
    return measured, found.doubts


def judged(
    drive: str,
    measured: Measured,
    by_gps: Measured | None,
    reference: Reference | None,
    notes: tuple[str, ...],
) -> DriveDistance:
    """GPS alone beside the reference, where there are both."""
    error_pct = stds = None
    if by_gps is not None and reference is not None and reference.distance_m > 0.0:
        off_m = by_gps.distance_m - reference.distance_m
        error_pct = 100.0 * off_m / reference.distance_m
        stds = off_m / by_gps.distance_std_m
    return DriveDistance(
        drive=drive,
        measured=measured,
        by_gps=by_gps,
        reference=None if reference is None else reference.kind,
        reference_m=None if reference is None else reference.distance_m,
        error_pct=error_pct,
        stds=stds,
        notes=notes,
    )


def distance_report(drives: Sequence[DriveDistance]) -> DistanceReport:
    """All together; at least one."""
    errors_pct = np.abs([each.error_pct for each in drives if each.error_pct is not None])
    stds = np.abs([each.stds for each in drives if each.stds is not None])
    middle = mean = high = most = inside = None
    if len(errors_pct):
        middle, high, most = (float(value) for value in np.percentile(errors_pct, [50, 95, 100]))
        mean, inside = float(errors_pct.mean()), float(np.mean(stds <= 2.0))
    return DistanceReport(
        drives=tuple(drives),
        error_p50_pct=middle,
        error_mean_pct=mean,
        error_p95_pct=high,
        error_max_pct=most,
        in_two_std=inside,
    )
