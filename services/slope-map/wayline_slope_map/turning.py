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

    def turned_m(self, pose: Pose) -> float | None:
        """Where a vehicle that has now surely turned began to go the other way; None else."""
        if pose.speed_mps is None or abs(pose.speed_mps) < STANDING_MPS:
            return None
        if (pose.speed_mps < 0.0) == self._is_backwards:
            self._since_m = None
            return None
        # a restart of fusion counts the distance anew
        since_m = min(pose.distance_m if self._since_m is None else self._since_m, pose.distance_m)
        has_turned = pose.distance_m - since_m >= TURNED_M
        self._is_backwards ^= has_turned
        self._since_m = None if has_turned else since_m
        return since_m if has_turned else None
