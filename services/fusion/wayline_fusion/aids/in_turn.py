"""Pure: several aids that take the same kind of event, one after the other."""

from typing import Any

from wayline_fusion.filter.estimate import Aid, Estimate
from wayline_fusion.filter.gate import Outcome


class InTurn:
    """Gives each event to its aids in order; the last one's outcome counts.

    Starts, goes on, stops and resets as each of them does.
    """

    def __init__(self, *aids: Aid) -> None:
        self._aids = aids

    @property
    def evidence(self) -> tuple[Any, ...]:
        """Of each aid, in their order."""
        return tuple(aid.evidence for aid in self._aids)

    @evidence.setter
    def evidence(self, evidence: tuple[Any, ...]) -> None:
        for aid, each in zip(self._aids, evidence, strict=True):
            aid.evidence = each

    def take(self, estimate: Estimate, event: Any) -> Outcome:
        """Let each aid use the event."""
        *_, last = [aid.take(estimate, event) for aid in self._aids]
        return last
