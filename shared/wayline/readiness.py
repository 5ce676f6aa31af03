"""Pure: what a service lacks of what it works with, and since when (SPEC section 5)."""

from collections.abc import Iterable
from typing import NamedTuple

from wayline.messages import EARLIEST_NS, LIST_MAX, TEXT_MAX, Missing

SILENT_S = 10.0
"""Nothing heard for so long is worth saying..."""
INTERVAL_MAX_S = 120.0
"""...of sources that report seldom, three times their usual interval, which is at most this."""
FORGET = 0.9
"""A long interval is forgotten over some ten shorter ones."""


class Lack(NamedTuple):
    """Something that is not there."""

    subject: str
    """`router`, `input`, a source's name, `database`."""
    what: str
    """What is wrong with it, for people."""


class Readiness:
    """Keeps since when each subject has been lacking, by the monotonic clock."""

    def __init__(self) -> None:
        self._lacks: dict[str, Lack] = {}
        self._since_s: dict[str, float] = {}

    def note(self, lacks: Iterable[Lack], now_s: float) -> None:
        """Take all that is lacking now; what is not among it is there."""
        self._lacks = {lack.subject: lack for lack in lacks}
        self._since_s = {name: self._since_s.get(name, now_s) for name in self._lacks}

    def missing(self, now_s: float, now_ns: int) -> tuple[Missing, ...]:
        """What is lacking, for `health`; `now_ns` is Unix time."""
        return tuple(
            Missing(
                subject=name[:TEXT_MAX],
                what=lack.what[:TEXT_MAX],
                since_ns=max(now_ns - round((now_s - self._since_s[name]) * 1e9), EARLIEST_NS),
            )
            for name, lack in list(self._lacks.items())[:LIST_MAX]
        )


class Hearing:
    """Whether anything is heard at all; times are of the monotonic clock."""

    def __init__(self) -> None:
        self._heard_s: float | None = None
        self._interval_s = 0.0

    def hear(self, now_s: float) -> None:
        """Something came."""
        if self._heard_s is not None:
            gap_s = min(now_s - self._heard_s, INTERVAL_MAX_S)
            self._interval_s = max(gap_s, FORGET * self._interval_s)
        self._heard_s = now_s

    def is_silent(self, now_s: float) -> bool:
        """Whether nothing came yet, or for longer than its sources usually take."""
        if self._heard_s is None:
            return True
        return now_s - self._heard_s > max(SILENT_S, 3.0 * self._interval_s)
