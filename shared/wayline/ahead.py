"""Pure: which messages lie too far ahead of the host's clock, and when that clock is overruled."""

from wayline.messages import Message

AHEAD_NS = 60_000_000_000
"""Beyond receipt: more than clocks that are kept differ by (SPEC section 2)."""
OVERRULED_S = 10.0
OVERRULED_COUNT = 10
"""Of a topic nothing else came for so long: then it is the host's clock that is behind."""


class Ahead:
    """Refuses what lies ahead, as long as anybody's message of its topic is on time.

    A computer that starts with the time of its last shutdown would else refuse every receiver,
    and a server whose clock is behind its whole fleet.
    """

    def __init__(self) -> None:
        self._ahead: dict[type[Message], tuple[float, int]] = {}
        """By topic of which nothing was on time since: since when, and how many were ahead."""

    def refuses(self, topic: type[Message], ahead_ns: int, now_s: float) -> bool:
        """Whether a message so far ahead of its receipt is refused.

        `now_s` is of the monotonic clock.
        """
        if ahead_ns <= AHEAD_NS:
            self._ahead.pop(topic, None)
            return False
        since_s, count = self._ahead.get(topic, (now_s, 0))
        self._ahead[topic] = since_s, count + 1
        return now_s - since_s < OVERRULED_S or count < OVERRULED_COUNT
