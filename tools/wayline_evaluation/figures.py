"""Pure: the figures that sum up errors: how large they are, how honest their stds are."""

import math

import msgspec
import numpy as np
from scipy.stats import chi2

from wayline_evaluation.estimates import Floats
from wayline_evaluation.pose_errors import PoseErrors

ONE_SIGMA, TWO_SIGMA = (float(share) for share in chi2.cdf([1.0, 4.0], 1))
ELLIPSES = tuple(float(bound) for bound in chi2.ppf([ONE_SIGMA, TWO_SIGMA], 2))
"""NEES within which 68.3 and 95.4 % of positions lie, both axes together."""


class Figures(msgspec.Struct, frozen=True, kw_only=True):
    """Of the absolute values of one error; the unit is in the name of what holds this."""

    count: int
    rms: float
    p50: float
    p68: float
    p90: float
    p95: float
    max: float


class Errors(msgspec.Struct, frozen=True, kw_only=True):
    """One `Figures` a quantity; null where the reference does not know it."""

    horizontal_m: Figures | None
    cross_track_m: Figures | None
    along_track_m: Figures | None
    heading_deg: Figures | None
    speed_mps: Figures | None
    alt_m: Figures | None
    grade_pct: Figures | None


class Inside(msgspec.Struct, frozen=True, kw_only=True):
    """Shares of errors inside 1 and 2 of their stds; 0.683 and 0.954 where these are honest."""

    count: int
    one_sigma: float
    two_sigma: float


class Consistency(msgspec.Struct, frozen=True, kw_only=True):
    """Errors against the stds that came with them; null where either is unknown."""

    east: Inside | None
    north: Inside | None
    ellipse: Inside | None
    """Position, both axes: inside the ellipses that hold 68.3 and 95.4 % (chi-square of 2)."""
    nees_mean: float | None
    """2 where the covariance is honest; a few gross errors dominate it."""
    nees_p50: float | None
    """1.39 where the covariance is honest."""
    heading: Inside | None
    speed: Inside | None
    alt: Inside | None
    grade: Inside | None


def figures_of(errors: Floats) -> Figures | None:
    """Of errors of either sign; None where none is known."""
    known = np.abs(errors[~np.isnan(errors)])
    if len(known) == 0:
        return None
    p50, p68, p90, p95 = (float(value) for value in np.percentile(known, [50, 68, 90, 95]))
    return Figures(
        count=len(known),
        rms=math.sqrt(float(np.mean(np.square(known)))),
        p50=p50,
        p68=p68,
        p90=p90,
        p95=p95,
        max=float(np.max(known)),
    )


def errors_of(errors: PoseErrors) -> Errors:
    """Figures of every quantity."""
    return Errors(**{name: figures_of(getattr(errors, name)) for name in Errors.__struct_fields__})


def consistency_of(errors: PoseErrors) -> Consistency:
    """How often errors are as large as their stds say."""
    nees = errors.nees()
    known = nees[~np.isnan(nees)]
    return Consistency(
        east=_inside(np.square(errors.east_m / _positive(errors.east_std_m)), (1.0, 4.0)),
        north=_inside(np.square(errors.north_m / _positive(errors.north_std_m)), (1.0, 4.0)),
        ellipse=_inside(nees, ELLIPSES),
        nees_mean=float(np.mean(known)) if len(known) else None,
        nees_p50=float(np.median(known)) if len(known) else None,
        heading=_inside(np.square(errors.heading_deg / _positive(errors.heading_std_deg))),
        speed=_inside(np.square(errors.speed_mps / _positive(errors.speed_std_mps))),
        alt=_inside(np.square(errors.alt_m / _positive(errors.alt_std_m))),
        grade=_inside(np.square(errors.grade_pct / _positive(errors.grade_std_pct))),
    )


def _positive(stds: Floats) -> Floats:
    """A std of 0 is none."""
    return np.where(stds > 0.0, stds, np.nan)


def _inside(squares: Floats, bounds: tuple[float, ...] = (1.0, 4.0)) -> Inside | None:
    known = squares[~np.isnan(squares)]
    if len(known) == 0:
        return None
    one, two = (float(np.mean(known <= bound)) for bound in bounds)
    return Inside(count=len(known), one_sigma=one, two_sigma=two)


def ratio_of(figures: Figures | None, yardstick: Figures | None) -> Figures | None:
    """Figures as multiples of the yardstick's; None where either is unknown or it is perfect."""
    if figures is None or yardstick is None:
        return None
    names = [name for name in Figures.__struct_fields__ if name != "count"]
    pairs = {name: (getattr(figures, name), getattr(yardstick, name)) for name in names}
    if any(bar == 0.0 for _, bar in pairs.values()):
        return None
    return Figures(count=figures.count, **{name: ours / bar for name, (ours, bar) in pairs.items()})
