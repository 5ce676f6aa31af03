"""Pure: fixes so far apart that the way between them is not known."""

from wayline_fusion.filter.estimate import Estimate
from wayline_fusion.filter.gate import UNUSED, Outcome
from wayline_fusion.filter.states import States
from wayline_fusion.intake.events import FixInterval

BENT_M = 5.0
"""A wrong heading bends the way by so much more than its derivatives say; fixes are as wrong."""


class LongWay:
    """The way between two fixes.

    Starts: without a gyro the heading has become unsure since the last fix, and the way is long.
    Goes on: before each fix the position is set free from how the vehicle came there, so that a
    new heading and a new speed do not move it; its std stays, and its gate with it. Stops: a gyro
    tells the turns, or fixes come often enough. Resets: nothing else.
    """

    def __init__(self) -> None:
        self.evidence = None

    def take(self, estimate: Estimate, interval: FixInterval) -> Outcome:
        """Take note of how often fixes come, before one is used."""
        estimate.know(fix_interval_s=interval.usual_s)
        if estimate.located and _is_way_unknown(estimate, interval.t_ns):
            estimate.filter.reset_way()
            estimate.know(way_unknown_ns=interval.t_ns)
        return UNUSED


def _is_way_unknown(estimate: Estimate, t_ns: int) -> bool:
    accepted_ns = estimate.situation.accepted_fix_ns
    if accepted_ns is None or estimate.gyro.covers(t_ns):
        return False
    kalman = estimate.filter
    fastest_mps = abs(kalman.speed_mps) + kalman.speed_std_mps
    way_m = fastest_mps * (t_ns - accepted_ns) * 1e-9
    return way_m * kalman.std(States.HEADING) ** 2 > BENT_M
