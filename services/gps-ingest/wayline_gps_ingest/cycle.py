"""Pure: which sentences make an epoch, and when it is complete."""

from dataclasses import dataclass

from wayline_gps_ingest.decode import Observation
from wayline_gps_ingest.epoch import POSITION_KINDS, Epoch

SAME_TIME_NS = 5_000_000
"""Times this near are one instant, told with more decimals by one sentence than by another."""


ENDINGS_MAX = 16
"""More ways to begin a cycle than a receiver has; noise must not fill memory."""


@dataclass(slots=True)
class Ending:
    """How the cycles that begin with one sentence end, as far as it is known."""

    last: str = ""
    """The sentence that ended two in a row."""
    candidate: str = ""
    timed: frozenset[str] = frozenset()
    """The timed sentences of the last epoch."""
    needed: frozenset[str] = frozenset()
    """The timed sentences that the last two epochs shared."""

    def learn(self, latest: str, timed_keys: frozenset[str]) -> None:
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
        self._latest = ""

    def begin(self, key: str) -> None:
        """A cycle's first timed sentence."""
        if len(self._endings) > ENDINGS_MAX:
            self._endings.clear()
        self._ending = self._endings.setdefault(key, Ending())

    def note(self, key: str) -> None:
        """A sentence of the current cycle; the second of a key is told from the first."""
        times = self._seen[key] = self._seen.get(key, 0) + 1
        self._latest = key if times == 1 else f"{key}#{times}"

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
        self._latest = ""

    def forget(self) -> None:
        """A cycle went on after what was taken for its end."""
        self._ending.last = self._ending.candidate = ""


class EpochAssembler:
    """Sentences in, complete epochs out, of one receiver.

    An epoch ends with the sentence that ended the last ones, or when a sentence of another time
    comes, or when `finish` says that no more will. Sentences without time belong to the epoch that
    is open, or to the next one if none is; a position sentence without time (a receiver that
    knows neither) ends what is open and tells nothing else.

    A sentence that comes twice with the same time starts a second pass. When the pass holds every
    timed sentence of the first it is a repeat: the receiver sent its last fix again. Else it is
    the second burst of an epoch sent in two, merged in if the epoch is still open.
    """

    def __init__(self) -> None:
        self._order = SentenceOrder()
        self._first: Epoch | None = None
        self._second: Epoch | None = None
        self._ahead = Epoch()
        self._ended = False

    @property
    def open_time_ns(self) -> int | None:
        """Time of day of an epoch that waits for its end."""
        return None if self._first is None or self._ended else self._first.time_ns

    def add(self, observation: Observation) -> list[Epoch]:
        """Epochs that this sentence ends, in order."""
        complete: list[Epoch] = []
        time_ns = observation.time_ns
        if time_ns is None and observation.kind in POSITION_KINDS:
            self._ahead = Epoch()
            return self.finish()
        if time_ns is not None and self._is_next(time_ns):
            complete += self._end_cycle()
        epoch = self._epoch_of(observation)
        epoch.add(observation)
        self._order.note(observation.key)
        if not self._ended and self._first and self._order.at_end(self._first.timed_keys):
            complete += self.finish()
        elif self._second and self._first and epoch is self._second:
            complete += self._repeated(self._first, epoch)
        return complete

    def finish(self) -> list[Epoch]:
        """The open epoch, taken as complete."""
        if self._first is None or self._ended:
            return []
        self._ended = True
        if self._second:
            self._first.merge(self._second)
            self._second = None
        return [self._first] if self._first.has_position else []

    def _is_next(self, time_ns: int) -> bool:
        """Whether a time is another than the current cycle's."""
        if self._first is None or self._first.time_ns is None:
            return False
        return abs(time_ns - self._first.time_ns) > SAME_TIME_NS

    def _epoch_of(self, observation: Observation) -> Epoch:
        if self._first is None:
            if observation.time_ns is None:
                return self._ahead
            self._first, self._ahead = self._ahead, Epoch()
            self._order.begin(observation.key)
            return self._first
        if self._second:
            return self._second
        if observation.time_ns is None:
            return self._ahead if self._ended else self._first
        return self._same_time(observation, self._first)

    def _same_time(self, observation: Observation, first: Epoch) -> Epoch:
        known = observation.key in first.timed_keys
        if not known and self._ended:
            self._order.forget()
        if not known and not self._ended:
            return first
        self._second, self._ahead = self._ahead, Epoch()
        return self._second

    def _repeated(self, first: Epoch, second: Epoch) -> list[Epoch]:
        """Once the second pass has all that the first had: the first if still open, a repeat."""
        if not first.timed_keys <= second.timed_keys:
            return []
        self._second = None
        second.repeat = second.has_position
        complete = self.finish()
        return [*complete, second] if second.repeat else complete

    def _end_cycle(self) -> list[Epoch]:
        complete = self.finish()
        if self._first and self._first.has_position:
            self._order.end_cycle(self._first.timed_keys)
        else:
            self._order.skip_cycle()
        self._first = self._second = None
        self._ended = False
        return complete
