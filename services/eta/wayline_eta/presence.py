"""Pure: whether a vehicle is on its route, with hysteresis."""

from wayline.tuning import Tuning
from wayline_eta.place_tracker import Place

MATCHES_TO_CHANGE = 2
SIGMAS = 2.0
"""How much of a pose's own uncertainty is given to it before its offset counts as a detour."""
SAME_WAY_DEG, WRONG_WAY_DEG = 75.0, 120.0
"""Between the two a vehicle turns, or crosses the route: that tells nothing."""


class Presence:
    """Off the route after two bad matches in a row, on it after two good ones; starts off.

    Bad is farther away than `tuning.off_route_m` and two sigma, or heading the wrong way; good is
    within `tuning.on_route_m`, known at least so well, and heading the route's way or standing.
    What is neither changes nothing.
    """

    def __init__(self, tuning: Tuning) -> None:
        self._tuning = tuning
        self._good = self._bad = 0
        self.on_route = False

    def observe(self, place: Place, speed_mps: float) -> bool:
        """Take the next match and say whether the vehicle is on the route."""
        tuning, offset_m = self._tuning, abs(place.cross_track_m)
        known_m, turn_deg = place.across_std_m, place.turn_deg
        moving = abs(speed_mps) >= tuning.eta_moving_mps
        wrong_way = moving and turn_deg > WRONG_WAY_DEG
        same_way = turn_deg < SAME_WAY_DEG or abs(speed_mps) < tuning.eta_standing_mps
        if wrong_way or offset_m > tuning.off_route_m + SIGMAS * known_m:
            self._good, self._bad = 0, self._bad + 1
        elif max(offset_m, known_m) <= tuning.on_route_m and same_way:
            self._good, self._bad = self._good + 1, 0
        if self._bad >= MATCHES_TO_CHANGE:
            self.on_route = False
        elif self._good >= MATCHES_TO_CHANGE:
            self.on_route = True
        return self.on_route
