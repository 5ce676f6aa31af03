"""Pure: the places of a line where a vehicle may be, given where it was seen."""

from typing import NamedTuple

import numpy as np

from wayline.line import Line

SPREAD_M = 200.0
"""Places this much farther away than the nearest one are not worth a thought."""


class Near(NamedTuple):
    """A locally nearest point of a line."""

    along_m: float
    offset_m: float
    """Of the seen position from the line, positive to the right of the line's direction."""
    heading_deg: float
    """Of the line."""


def locally_nearest(line: Line, lat_deg: float, lon_deg: float) -> list[Near]:
    """Every point of a line that is nearer than the line just before and after it, in order.

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
    nearest = found.nonzero()[0]
    offsets_m = np.copysign(legs.offsets_m[nearest], legs.sides[nearest])
    columns = (legs.alongs_m[nearest], offsets_m, line.headings_deg[nearest])
    return [Near(*each) for each in zip(*(column.tolist() for column in columns), strict=True)]
