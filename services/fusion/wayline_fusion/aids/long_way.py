"""Pure: fixes so far apart that the way between them is not known."""

from wayline_fusion.filter.estimate import Estimate
from wayline_fusion.filter.gate import UNUSED, Outcome
from wayline_fusion.intake.events import FixInterval


class LongWay:
    """The way between two fixes.

    Starts: without a gyro the heading has become unsure since the last fix. Goes on: before each
    fix the position is set free from how the vehicle came there, so that a new heading and a new
    speed do not move it; its std stays, and its gate with it. Stops: a gyro tells the turns, or
    fixes come often enough. Resets: nothing else.
    """

    def __init__(self) -> None:
        self.evidence = None

    def take(self, estimate: Estimate, interval: FixInterval) -> Outcome:
        """Take note of how often fixes come, before one is used."""
        estimate.know(fix_interval_s=interval.usual_s)
        if estimate.located and estimate.turns_unknown:
            estimate.filter.reset_way()
        return UNUSED
