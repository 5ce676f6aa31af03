"""Pure: a smooth curve through points in a plane, with bends that a vehicle can take."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import Akima1DInterpolator
from scipy.ndimage import gaussian_filter1d, maximum_filter1d

from wayline_simulator.course import STEP_M, Floats

LEAST_RADIUS_M = 6.0
"""A car's turning circle; a bus that is drawn round a corner so tightly is drawn wrongly."""
CORNER_DEG = 20.0
"""From here on a vertex is a corner and no sample of a bend."""
CORNER_REACH_M = 12.0
"""Beyond which a corner does not bend its legs."""
BEND_REACH_M = 40.0
"""On a leg of more than twice this the line is straight but so near its ends: a chord of a bend
drawn with such vertices would be far off the road."""
THIN_M = 4.0
"""Points nearer together than this say more about a receiver's noise than about the road."""
SMOOTH_M = 4.0
"""Std of the first Gaussian over the line; more follows only where it bends too tightly."""
AGAIN_M = 2.0
"""Std of each that follows."""
ROUNDS = 400
"""Rounds of more smoothing; a right angle needs 10 or so, a hairpin of parallel legs a hundred."""
PAD_M = 300.0
"""So much of a loop's line is repeated before and behind, so that both its ends see one curve."""


class Knots(NamedTuple):
    """Points of a line, shape (n,) each; what `places_m` measures is the caller's."""

    east_m: Floats
    north_m: Floats
    chords_m: Floats
    """Straight from point to point, added up."""
    places_m: Floats


class Curve(NamedTuple):
    """Dense samples, shape (n,) each; a loop's go on over both its ends."""

    east_m: Floats
    north_m: Floats
    places_m: Floats
    within: NDArray[np.bool_]
    """Not before the line's begin nor behind its end."""


class TooTightError(Exception):
    """A line that doubles back; says where, in the plane."""

    def __init__(self, east_m: float, north_m: float) -> None:
        self.east_m, self.north_m = east_m, north_m
        super().__init__(f"no bend fits at {east_m:.0f} m east, {north_m:.0f} m north")


def smooth_curve(east_m: Floats, north_m: Floats, places_m: Floats, *, loop: bool) -> Curve:
    """The curve through a line's points, a loop's last being its first. Raises TooTightError."""
    knots = _thinned(east_m, north_m, places_m)
    whole_m = float(knots.chords_m[-1])
    step_m = whole_m / math.ceil(2.0 * whole_m / STEP_M)
    before = int(min(PAD_M, whole_m / 2.0) / step_m) if loop else 0
    if loop:
        knots = _around(knots)
    steps = np.arange(-before, round(whole_m / step_m) + before + 1)
    at_m = np.asarray(steps * step_m, dtype=np.float64)
    rounded_m = _rounded(_spline(knots, at_m), step_m)
    return Curve(
        rounded_m[:, 0],
        rounded_m[:, 1],
        np.interp(at_m, knots.chords_m, knots.places_m),
        (steps >= 0) & (steps <= steps[-1] - before),
    )


def blurred(values: Floats, std_samples: float) -> Floats:
    """A Gaussian over rows that go straight on at both ends, so that these stay."""
    count = min(math.ceil(4.0 * std_samples), len(values) - 1)
    before = 2.0 * values[0] - values[count:0:-1]
    behind = 2.0 * values[-1] - values[-2 : -count - 2 : -1]
    long = np.concatenate((before, values, behind))
    smooth: Floats = gaussian_filter1d(long, std_samples, axis=0, truncate=4.0)
    return smooth[count : count + len(values)]


def _thinned(east_m: Floats, north_m: Floats, places_m: Floats) -> Knots:
    """Points at least THIN_M from the one kept before, and the last."""
    kept = [0]
    for at in range(1, len(east_m) - 1):
        steps_m = (
            math.hypot(east_m[at] - east_m[other], north_m[at] - north_m[other])
            for other in (kept[-1], -1)
        )
        if next(steps_m) >= THIN_M and (next(steps_m) >= THIN_M or len(kept) == 1):
            kept.append(at)
    kept.append(len(east_m) - 1)
    east_m, north_m = east_m[kept], north_m[kept]
    legs_m = np.hypot(np.diff(east_m), np.diff(north_m))
    return Knots(east_m, north_m, np.concatenate(([0.0], np.cumsum(legs_m))), places_m[kept])


def _around(knots: Knots) -> Knots:
    """A loop's points with those of the lap before and the lap behind."""
    once = np.arange(len(knots.chords_m) - 1)
    at = np.concatenate((once, once, once, [len(once)]))
    lap = np.append(np.repeat([-1.0, 0.0, 1.0], len(once)), 1.0)
    return Knots(
        knots.east_m[at],
        knots.north_m[at],
        knots.chords_m[at] + lap * knots.chords_m[-1],
        knots.places_m[at] + lap * knots.places_m[-1],
    )


def _spline(knots: Knots, at_m: Floats) -> Floats:
    """The line by chord length: bends through its vertices, straight but near its corners."""
    along_m = knots.chords_m
    headings_rad = np.arctan2(np.diff(knots.east_m), np.diff(knots.north_m))
    turns_rad = np.abs(np.angle(np.exp(1j * np.diff(headings_rad))))
    corners_m = along_m[1:-1][turns_rad > math.radians(CORNER_DEG)]
    corner_helpers_m = corners_m[:, None] + CORNER_REACH_M * np.array([-1.0, -0.5, 0.5, 1.0])
    long = np.diff(along_m) > 2.0 * BEND_REACH_M
    ends_m = (along_m[:-1][long] + BEND_REACH_M, along_m[1:][long] - BEND_REACH_M)
    helpers_m = np.concatenate((corner_helpers_m.ravel(), *ends_m))
    inside = (helpers_m > along_m[0]) & (helpers_m < along_m[-1])
    all_m = np.sort(np.concatenate((along_m, helpers_m[inside])))
    all_m = all_m[np.diff(all_m, prepend=-np.inf) > 1e-3]
    axes = [np.interp(all_m, along_m, axis_m) for axis_m in (knots.east_m, knots.north_m)]
    spline = Akima1DInterpolator(all_m, np.column_stack(axes), method="makima", extrapolate=True)
    return np.asarray(spline(at_m), dtype=np.float64)


def _rounded(line_m: Floats, step_m: float) -> Floats:
    """The line, smoothed all along and then again and again where it bends too tightly."""
    reach = round(2.0 * LEAST_RADIUS_M / step_m)
    line_m = blurred(line_m, SMOOTH_M / step_m)
    for _ in range(ROUNDS):
        tight = np.abs(_curvature(line_m)) > 1.0 / LEAST_RADIUS_M
        if not tight.any():
            return line_m
        near = maximum_filter1d(tight.astype(np.float64), 2 * reach + 1)
        share = gaussian_filter1d(near, reach / 3.0)[:, None]
        line_m = line_m + share * (blurred(line_m, AGAIN_M / step_m) - line_m)
    east_m, north_m = line_m[int(np.argmax(tight))]
    raise TooTightError(float(east_m), float(north_m))


def _curvature(line_m: Floats) -> Floats:
    """At the points of a line, positive to the right; a point where it doubles back is a turn."""
    chords = np.diff(line_m[:, 1] + 1j * line_m[:, 0])
    turns_rad = np.angle(chords[1:] * np.conj(chords[:-1]))
    lengths_m = (np.abs(chords[1:]) + np.abs(chords[:-1])) / 2.0
    return np.pad(turns_rad / np.maximum(lengths_m, 1e-9), 1)
