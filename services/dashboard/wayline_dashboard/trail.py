"""Pure: where a vehicle has been, thinned and bounded."""

import math
from collections import deque
from itertools import takewhile

import msgspec

from wayline.geo import metres_per_degree
from wayline.messages import Pose, PoseMode

SPACING_M = 4.0
"""Finer is not seen on a screen that shows a street."""
POINTS_MAX = 2000
"""8 km at least; more would make a snapshot slow on a phone."""
METRES_STALE_DEG = 0.1
"""Metres per degree of longitude change by 0.2 % over this much latitude, at 50 degrees."""


class TrailPoint(msgspec.Struct, frozen=True, gc=False):
    """A place that the vehicle passed, and what the estimate rested on there."""

    lat_deg: float
    lon_deg: float
    mode: PoseMode


class Trail:
    """Points at least `SPACING_M` apart, each with the revision it came with; revisions grow.

    A reader that missed points that are no longer held has to take the trail anew, and so has
    one that was told nothing.
    """

    def __init__(self) -> None:
        self._points: deque[tuple[int, int, TrailPoint]] = deque(maxlen=POINTS_MAX)
        """With their revision and instant."""
        self._lost_revision = 0
        """Of the newest point that is no longer held."""
        self._metres_lat_deg = math.inf
        self._metres = (0.0, 0.0)

    def clear(self, revision: int) -> None:
        """Begin anew, so that every reader does too."""
        self._points.clear()
        self._lost_revision = revision

    def add(self, pose: Pose, revision: int) -> None:
        """Keep a pose's position if it is far enough from the last one kept."""
        if pose.lat_deg is None or pose.lon_deg is None:
            return
        if self._points and self._is_near(pose.lat_deg, pose.lon_deg, self._points[-1][2]):
            return
        if len(self._points) == POINTS_MAX:
            self._lost_revision = self._points[0][0]
        point = TrailPoint(pose.lat_deg, pose.lon_deg, pose.mode)
        self._points.append((revision, pose.t_ns, point))

    @property
    def began_ns(self) -> int | None:
        """When the vehicle was at the oldest point that is held."""
        return self._points[0][1] if self._points else None

    def since(self, known: int) -> tuple[TrailPoint, ...]:
        """The points that came after a revision, as far as they are still held."""
        newest_first = takewhile(lambda held: held[0] > known, reversed(self._points))
        return tuple(point for _, _, point in newest_first)[::-1]

    def is_missed(self, known: int) -> bool:
        """Whether a reader that knows a revision missed points that are no longer held."""
        return known < self._lost_revision

    def _is_near(self, lat_deg: float, lon_deg: float, last: TrailPoint) -> bool:
        # a geodesic for every pose would cost more than all the rest of the view
        if abs(lat_deg - self._metres_lat_deg) > METRES_STALE_DEG:
            self._metres, self._metres_lat_deg = metres_per_degree(lat_deg), lat_deg
        north_m = (lat_deg - last.lat_deg) * self._metres[0]
        east_m = (lon_deg - last.lon_deg) * self._metres[1]
        return math.hypot(east_m, north_m) < SPACING_M
