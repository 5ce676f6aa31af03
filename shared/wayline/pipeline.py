"""Pure: the bus in one process. What one core publishes, the cores that read it get, in order."""

from collections import deque
from collections.abc import Callable, Iterable, Sequence

from wayline.messages import Message
from wayline.node import Node

Publish = Callable[[Message, str], None]
"""Called once for every message on the bus, with its source."""


class Pipeline:
    """Feeds messages to nodes until nothing more follows from them."""

    def __init__(self, nodes: Sequence[Node], publish: Publish) -> None:
        self._nodes = nodes
        self._publish = publish
        self._readers: dict[type[Message], list[Node]] = {}
        for node in nodes:
            for message_type in node.core.reads:
                self._readers.setdefault(message_type, []).append(node)
        self._last_ns = 0

    def feed(self, message: Message, source: str) -> None:
        """Put one message on the bus."""
        self._last_ns = max(self._last_ns, message.t_ns)
        self._spread([(message, source)])

    def finish(self) -> None:
        """End of input: every core finishes what is open, upstream first."""
        for node in self._nodes:
            self._spread((message, node.name) for message in node.finish(self._last_ns))

    def _spread(self, messages: Iterable[tuple[Message, str]]) -> None:
        queue = deque(messages)
        while queue:
            message, source = queue.popleft()
            self._publish(message, source)
            for node in self._readers.get(type(message), ()):
                queue.extend((output, node.name) for output in node.take(message, source))
