"""Pure: predictions of a core, remembered as it says them, and scored once they have come."""

from collections.abc import Callable, Iterable, Sequence

import msgspec

from wayline.core import Record, Sleep
from wayline.inputs import Flush, Tick
from wayline.messages import Arrivals, Message, Progress, StopEvent
from wayline_eta.promises import EVERY_NS, Promises
from wayline_eta.records import Scored


class Scoring:
    """Of what a core says of one vehicle once a second; `tell` is told of the scores too."""

    def __init__(self, tell: Callable[[Scored], None]) -> None:
        self._tell = tell
        self._promises = Promises()

    def add_to(
        self, said: Sequence[Message | Record | Sleep], message: msgspec.Struct
    ) -> Sequence[Message | Record | Sleep]:
        """What was said to an input; at a whole minute and at the end with how good that was."""
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
