"""Pure: where a vehicle has been, thinned and bounded."""

import math
from collections import deque
from itertools import islice

import msgspec

from wayline.geo import metres_per_degree
from wayline.messages import Pose, PoseMode

SPACING_M = 4.0
"""Finer is not seen on a screen that shows a street."""
POINTS_MAX = 2000
"""8 km at least; more would make a snapshot slow on a phone."""
METRES_STALE_DEG = 0.1
"""Metres per degree of longitude change by 0.2 % over this much latitude, at 50 degrees."""


class TrailPoint(msgspec.Struct, frozen=True):
    """A place that the vehicle passed, and what the estimate rested on there."""

    lat_deg: float
    lon_deg: float
    mode: PoseMode


class Trail:
    """Points at least `SPACING_M` apart, numbered from 1; `count` is the newest one's number.

    A reader that knows less than `start` has missed points that are no longer held, so it has to
    take the trail anew; one that knows nothing (0) always has.
    """

    def __init__(self) -> None:
        self.count = 1
        self._points: deque[TrailPoint] = deque(maxlen=POINTS_MAX)
        self._metres_lat_deg = math.inf
        self._metres = (0.0, 0.0)

    @property
    def start(self) -> int:
        """The number before the oldest point held."""
        return self.count - len(self._points)

    def clear(self) -> None:
        """Begin anew, so that every reader does too."""
        self._points.clear()
        self.count += 1

    def add(self, pose: Pose) -> bool:
        """Keep a pose's position if it is far enough from the last one kept."""
        if pose.lat_deg is None or pose.lon_deg is None:
            return False
        if self._points and self._is_near(pose.lat_deg, pose.lon_deg, self._points[-1]):
            return False
        self._points.append(TrailPoint(pose.lat_deg, pose.lon_deg, pose.mode))
        self.count += 1
        return True

    def since(self, count: int) -> tuple[TrailPoint, ...]:
        """The points kept after there had been `count` of them, as far as they are still held."""
        fresh = min(self.count - count, len(self._points))
        return tuple(islice(self._points, len(self._points) - fresh, None))

    def _is_near(self, lat_deg: float, lon_deg: float, last: TrailPoint) -> bool:
        # a geodesic for every pose would cost more than all the rest of the view
        if abs(lat_deg - self._metres_lat_deg) > METRES_STALE_DEG:
            self._metres, self._metres_lat_deg = metres_per_degree(lat_deg), lat_deg
        north_m = (lat_deg - last.lat_deg) * self._metres[0]
        east_m = (lon_deg - last.lon_deg) * self._metres[1]
        return math.hypot(east_m, north_m) < SPACING_M
