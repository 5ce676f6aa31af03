"""Pure: what a fix tells, as long as no satellites correct by themselves."""

from typing import Any

from wayline_fusion.filter.estimate import Aid, Estimate
from wayline_fusion.filter.gate import UNUSED, Outcome


class UnlessRanged:
    """Another aid, which is left out beside raw measurements: fixes are made of the same ranges.

    Starts: at once, so that fixes can begin an estimate. Goes on: each event goes to that aid.
    Stops: while raw measurements correct. Resets: never by itself.
    """

    def __init__(self, aid: Aid) -> None:
        self._aid = aid
        self.evidence = aid.evidence

    def take(self, estimate: Estimate, event: Any) -> Outcome:
        """Pass an event of a fix on, where nothing better tells."""
        if estimate.ranged:
            return UNUSED
        self._aid.evidence = self.evidence
        outcome = self._aid.take(estimate, event)
        self.evidence = self._aid.evidence
        return outcome
