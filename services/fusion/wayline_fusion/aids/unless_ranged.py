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

    @property
    def evidence(self) -> Any:
        """That of the other aid."""
        return self._aid.evidence

    @evidence.setter
    def evidence(self, evidence: Any) -> None:
        self._aid.evidence = evidence

    def take(self, estimate: Estimate, event: Any) -> Outcome:
        """Pass an event of a fix on, where nothing better tells."""
        return UNUSED if estimate.ranged else self._aid.take(estimate, event)
