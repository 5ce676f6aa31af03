"""Pure: a step of the clock that all sensors share."""

from wayline_fusion.filter.estimate import Estimate
from wayline_fusion.filter.gate import UNUSED, Outcome
from wayline_fusion.intake.events import ClockStep


class ClockJump:
    """A clock that was set.

    Starts: all sensors' time jumps. Goes on: never, each step is by itself. Stops: at once. Resets:
    the position is doubted by the way that the vehicle drives in such a time.
    """

    def __init__(self) -> None:
        self.evidence = None

    def take(self, estimate: Estimate, jump: ClockStep) -> Outcome:
        """Doubt the position."""
        estimate.filter.inflate_position(estimate.filter.speed_mps * jump.step_s)
        return UNUSED
