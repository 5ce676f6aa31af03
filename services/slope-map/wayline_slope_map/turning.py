"""Pure: where a vehicle begins to go backwards, or forwards again, and its run ends.

What climbs before it falls behind: no smoother joins the slopes of the two ways.
"""

from wayline.messages import Pose

TURNED_M = 10.0
"""Gone the other way: less is a manoeuvre, or the noise of one that stands."""
STANDING_MPS = 0.5


class Turning:
    """Watches the poses of one vehicle; it is taken to begin forwards."""

    def __init__(self) -> None:
        self._is_backwards = False
        self._since_m: float | None = None
        """Distance travelled at which it began to go the other way."""

    def is_over(self, pose: Pose) -> bool:
        """Whether a pose shows that the vehicle has turned to the other way for good."""
        if pose.speed_mps is None or abs(pose.speed_mps) < STANDING_MPS:
            return False
        if (pose.speed_mps < 0.0) == self._is_backwards:
            self._since_m = None
            return False
        # a restart of fusion counts the distance anew
        self._since_m = min(self._since_m or pose.distance_m, pose.distance_m)
        if pose.distance_m - self._since_m < TURNED_M:
            return False
        self._is_backwards, self._since_m = not self._is_backwards, None
        return True
