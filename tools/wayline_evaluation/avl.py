"""Pure: the published route filter beside the estimates that papers/000 prints, and its ellipses.

The paper's filter runs on its own fixes (appendix C) along its planned route (appendix B); printed
are its estimates (appendix D).
"""

from collections.abc import Sequence
from typing import NamedTuple

import msgspec
import numpy as np

from wayline.geo import metres_per_degree
from wayline_eta.avl_filter import Estimate
from wayline_evaluation.estimates import Floats


class Sample(NamedTuple):
    """A row of the fixes; a repeated one tells nothing."""

    lat_deg: float
    lon_deg: float
    is_repeat: bool


class Printed(NamedTuple):
    """An estimate that the paper prints."""

    row: int
    """Of the fixes, from 1 on."""
    lat_deg: float
    lon_deg: float


class Ellipse(NamedTuple):
    """Of one standard deviation about an estimate."""

    major_m: float
    minor_m: float
    heading_deg: float
    """Of the longer axis, true, from 0 to 180."""


class AxisScore(msgspec.Struct, frozen=True, kw_only=True):
    """Distances from the printed estimates along one axis."""

    mean_m: float
    rms_m: float
    max_m: float


class GapScore(msgspec.Struct, frozen=True, kw_only=True):
    """What the ellipse is after so many rows without a fix: means over all such rows."""

    rows_without: int
    count: int
    major_m: float
    minor_m: float
    off_route_deg: float
    """Of the longer axis, to the leg that it lies on."""


class AvlReport(msgspec.Struct, frozen=True, kw_only=True):
    """What `wayline evaluate avl --json` writes."""

    rows: int
    north: AxisScore
    east: AxisScore
    flat: AxisScore
    ends_at_row: int | None
    """Where the filter comes to the end of the route."""
    gaps: tuple[GapScore, ...]


def ellipse_of(estimate: Estimate) -> Ellipse:
    """The axes of an estimate's covariance."""
    variances_m2, axes = np.linalg.eigh(np.array(estimate.covariance_m2))
    minor_m, major_m = np.sqrt(np.maximum(variances_m2, 0.0)).tolist()
    east, north = axes[:, 1]
    return Ellipse(major_m, minor_m, float(np.degrees(np.arctan2(east, north))) % 180.0)


def avl_report(
    samples: Sequence[Sample], estimates: Sequence[Estimate], printed: Sequence[Printed]
) -> AvlReport:
    """One estimate a sample, those that are printed compared."""
    ours = [estimates[each.row - 1] for each in printed]
    degrees = np.array([(each.lat_deg, each.lon_deg) for each in ours])
    degrees -= np.array([(each.lat_deg, each.lon_deg) for each in printed])
    errors_m = degrees * np.array(metres_per_degree(printed[0].lat_deg))
    ended = [estimate.ended for estimate in estimates]
    return AvlReport(
        rows=len(printed),
        north=_axis(errors_m[:, 0]),
        east=_axis(errors_m[:, 1]),
        flat=_axis(np.hypot(*errors_m.T)),
        ends_at_row=ended.index(True) + 1 if True in ended else None,
        gaps=tuple(_gaps(samples, estimates)),
    )


def _axis(errors_m: Floats) -> AxisScore:
    apart_m = np.abs(errors_m)
    return AxisScore(
        mean_m=float(apart_m.mean()),
        rms_m=float(np.sqrt(np.mean(apart_m**2))),
        max_m=float(apart_m.max()),
    )


def _gaps(samples: Sequence[Sample], estimates: Sequence[Estimate]) -> list[GapScore]:
    """By how many rows the last fix is old."""
    found: dict[int, list[tuple[float, float, float]]] = {}
    without = 0
    for sample, estimate in zip(samples, estimates, strict=True):
        without = without + 1 if sample.is_repeat else 0
        ellipse = ellipse_of(estimate)
        off_deg = abs((ellipse.heading_deg - estimate.place.heading_deg + 90.0) % 180.0 - 90.0)
        found.setdefault(without, []).append((ellipse.major_m, ellipse.minor_m, off_deg))
    return [
        GapScore(
            rows_without=without,
            count=len(rows),
            major_m=float(np.mean([row[0] for row in rows])),
            minor_m=float(np.mean([row[1] for row in rows])),
            off_route_deg=float(np.mean([row[2] for row in rows])),
        )
        for without, rows in sorted(found.items())
    ]
