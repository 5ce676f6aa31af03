"""Pure: a core whose predictions are remembered, and scored once the vehicle has come."""

from collections.abc import Callable, Iterable, Sequence
from typing import ClassVar

import msgspec

from wayline.core import Core, Record, Sleep
from wayline.inputs import Flush, Tick
from wayline.messages import Arrivals, GpsFix, Message, Pose, Progress, StopEvent
from wayline_eta.promises import EVERY_NS, Promises
from wayline_eta.records import Scored


class ScoredCore:
    """Says what its core says, and once a minute how good that was; `scored` is told of it too.

    The core tells arrivals once a second.
    """

    reads: ClassVar[frozenset[type[Message]]] = frozenset({Pose, GpsFix})
    period_ns: ClassVar[int | None] = 1_000_000_000

    def __init__(self, core: Core, scored: Callable[[Scored], None]) -> None:
        self._core, self._tell = core, scored
        self._promises = Promises()

    def handle(self, message: msgspec.Struct, source: str) -> Sequence[Message | Record | Sleep]:
        """Hand the input on; what the core says of it, with scores."""
        said = self._core.handle(message, source)
        self._note(said)
        match message:
            case Flush(t_ns):
                return [*said, *self._scored(t_ns)]
            case Tick(t_ns) if t_ns % EVERY_NS == 0:
                return [*said, *self._scored(t_ns)]
        return said

    def _note(self, said: Iterable[Message | Record | Sleep]) -> None:
        progress = None
        for each in said:
            if isinstance(each, StopEvent):
                self._promises.happened(each)
            elif isinstance(each, Progress):
                progress = each
            elif isinstance(each, Arrivals):
                self._promises.note(progress, each)

    def _scored(self, t_ns: int) -> list[Scored]:
        scored = self._promises.take(t_ns)
        for each in scored:
            self._tell(each)
        return scored
