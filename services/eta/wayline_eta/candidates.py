"""Pure: the places of a line where a vehicle may be, given where it was seen."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wayline.line import Line

Floats = NDArray[np.float64]

SPREAD_M = 200.0
"""Places this much farther away than the nearest one are not worth a thought."""


class Candidates(NamedTuple):
    """Locally nearest points of a line in order of distance along it; all of shape (n,)."""

    alongs_m: Floats
    offsets_m: Floats
    """Of the seen position from the line, positive to the right of the direction of travel."""
    headings_deg: Floats


def locally_nearest(line: Line, lat_deg: float, lon_deg: float) -> Candidates:
    """Every point of a line that is nearer than the line just before and after it.

    A line that passes a place twice (a lap, a spur driven out and back) has one for each passage.
    The distance to a leg is convex along it, so such a point is inside a leg, or a vertex where
    the leg before ends at its nearest and the leg after begins at its own.
    """
    legs = line.project_legs(lat_deg, lon_deg)
    at_start = legs.alongs_m <= line.distances_m[:-1] + 1e-6
    at_end = legs.alongs_m >= line.distances_m[1:] - 1e-6
    found = ~(at_start | at_end)
    found[1:] |= at_start[1:] & at_end[:-1]
    found[0] |= at_start[0]
    found[-1] |= at_end[-1]
    found &= legs.offsets_m <= legs.offsets_m.min() + SPREAD_M
    return Candidates(
        legs.alongs_m[found],
        np.copysign(legs.offsets_m[found], legs.sides[found]),
        line.headings_deg[found],
    )
