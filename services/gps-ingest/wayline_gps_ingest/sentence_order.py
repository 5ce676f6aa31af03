"""Pure: how a receiver's cycle of sentences ends, learned from the cycles before."""

from dataclasses import dataclass

ENDINGS_MAX = 16
"""More ways to begin a cycle than a receiver has; noise must not fill memory."""

Place = tuple[str, int]
"""A sentence of a cycle, and how many of it there were with it."""
NONE: Place = ("", 0)


@dataclass(slots=True)
class Ending:
    """How the cycles that begin with one sentence end, as far as it is known."""

    last: Place = NONE
    """The sentence that ended two in a row."""
    candidate: Place = NONE
    timed: frozenset[str] = frozenset()
    """The timed sentences of the last epoch."""
    needed: frozenset[str] = frozenset()
    """The timed sentences that the last two epochs shared."""

    def learn(self, latest: Place, timed_keys: frozenset[str]) -> None:
        """Take in a cycle that the next one's first sentence has ended."""
        if latest == self.candidate:
            self.last = latest
        self.candidate = latest
        self.needed = self.timed & timed_keys
        self.timed = timed_keys


class SentenceOrder:
    """Learns how a receiver's cycle ends: with the sentence that ended the last two.

    Receivers leave sentences out of some cycles, so the end counts only when the timed sentences
    that the last two cycles shared have come. Some send two cycles in turn, each with a time of
    its own, so the end is learned for each timed sentence that begins one.
    """

    def __init__(self) -> None:
        self._endings: dict[str, Ending] = {}
        self._ending = Ending()
        self._seen: dict[str, int] = {}
        self._latest = NONE

    def begin(self, key: str) -> None:
        """A cycle's first timed sentence."""
        if len(self._endings) > ENDINGS_MAX:
            self._endings.clear()
        self._ending = self._endings.setdefault(key, Ending())

    def note(self, key: str) -> None:
        """A sentence of the current cycle; the second of a key is told from the first."""
        times = self._seen[key] = self._seen.get(key, 0) + 1
        self._latest = key, times

    def at_end(self, timed_keys: set[str]) -> bool:
        """Whether the latest sentence ends a cycle in which these timed sentences came."""
        return self._latest == self._ending.last and self._ending.needed <= timed_keys

    def end_cycle(self, timed_keys: set[str]) -> None:
        """Learn from a cycle that the next one's first sentence has ended."""
        self._ending.learn(self._latest, frozenset(timed_keys))
        self.skip_cycle()

    def skip_cycle(self) -> None:
        """The next cycle begins; nothing is to be learned from the one that ended."""
        self._seen.clear()
        self._latest = NONE

    def forget(self) -> None:
        """A cycle went on after what was taken for its end."""
        self._ending.last = self._ending.candidate = NONE
