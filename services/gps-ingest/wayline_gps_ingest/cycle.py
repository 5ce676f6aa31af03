"""Pure: which sentences make an epoch, and when it is complete."""

from collections import deque
from typing import NamedTuple

import msgspec

from wayline_gps_ingest.dates import nearest_ns
from wayline_gps_ingest.decode import Observation
from wayline_gps_ingest.epoch import POSITION_KINDS, Epoch
from wayline_gps_ingest.fields import SECOND_NS
from wayline_gps_ingest.sentence_order import SentenceOrder

SAME_TIME_NS = 5_000_000
"""Times this near are one instant, told with more decimals by one sentence than by another."""
LATE_MAX_NS = 2 * SECOND_NS
"""A link may bring sentences out of order by this much; what is further back is another clock."""
TOLD_MAX = 256
"""Epochs that are remembered: more than a receiver tells in the time above."""
HELD_MAX = 64
"""Sentences that wait for the next time; a receiver that tells none must not fill memory."""
COMPANIONS = frozenset(("ZDA", "GST"))
"""Kinds without a position: their time may be that of their sending."""


class Told(NamedTuple):
    """An epoch that is complete: its time of day and its timed sentences."""

    time_ns: int
    keys: set[str]


class EpochAssembler:
    """Sentences in, complete epochs out, of one receiver.

    An epoch ends with the sentence that ended the last ones, or when a sentence of another time
    comes, or when `finish` says that no more will. Sentences without time belong to the epoch that
    is open, or to the next one if none is; a position sentence without time (a receiver that
    knows neither) ends what is open and tells nothing else.

    A ZDA or GST may tell when it was sent instead of its epoch's time, so it never ends an epoch:
    it belongs to the next one where that has its very time, else to the one before.

    A sentence that comes twice with the same time starts a second pass. When the pass holds every
    timed sentence of the first it is a repeat: the receiver sent its last fix again. Else it is
    the second burst of an epoch sent in two, merged in if the epoch is still open.

    An open epoch is set aside for one of up to 2 s before it and gone on with afterwards; what
    belongs to an epoch that is complete already is too late (`late`) and dropped.
    """

    def __init__(self) -> None:
        self._order = SentenceOrder()
        self._first: Epoch | None = None
        self._second: Epoch | None = None
        self._aside: Epoch | None = None
        self._ahead = Epoch()
        self._ended = False
        self._held: list[Observation] = []
        self._told: deque[Told] = deque(maxlen=TOLD_MAX)
        self._newest_ns: int | None = None
        self._period_ns = 0
        self.late = 0
        """Sentences of epochs that were complete already."""

    @property
    def open_time_ns(self) -> int | None:
        """Time of day of an epoch that waits for its end."""
        waiting = self._aside if self._ended else self._first
        return None if waiting is None else waiting.time_ns

    def add(self, observation: Observation) -> list[Epoch]:
        """Epochs that this sentence ends, in order."""
        time_ns = observation.time_ns
        if time_ns is None and observation.kind in POSITION_KINDS:
            self._ahead = Epoch()
            return self.finish()
        if not self._held and (time_ns is None or (self._first and time_ns == self._first.time_ns)):
            return self._take(observation)
        return self._add_of_another_time(observation)

    def _add_of_another_time(self, observation: Observation) -> list[Epoch]:
        """Epochs that a sentence ends which may not be of the current cycle, in order."""
        observation = self._with_epoch_time(observation)
        if self._is_to_wait(observation):
            self._held.append(observation)
            return []
        time_ns = observation.time_ns
        if self._is_straggler(observation):
            self.late += 1
            return []
        complete: list[Epoch] = []
        held: list[Observation] = []
        if self._held:
            held, complete = self._placed(observation)
        if time_ns is not None and self._is_next(time_ns):
            complete += self._turn_to(time_ns)
        for each in held:
            complete += self._take(each)
        return complete + self._take(observation)

    def finish(self) -> list[Epoch]:
        """The open epochs, taken as complete."""
        complete = self._released() + self._finish_current()
        aside, self._aside = self._aside, None
        return complete + self._told_now(aside) if aside else complete

    def _with_epoch_time(self, observation: Observation) -> Observation:
        """A sentence that says less of the time than its epoch, or something else, as its epoch's.

        Receivers cut the decimals off in some sentences, and send ZDA and GST before half of the
        time to the next epoch is over.
        """
        epoch, time_ns = self._first, observation.time_ns
        if epoch is None or epoch.time_ns is None or time_ns is None:
            return observation
        after_ns = time_ns - epoch.time_ns
        if observation.kind in COMPANIONS:
            is_within = after_ns > SAME_TIME_NS and 2 * after_ns < self._period_ns
            return _untimed(observation) if is_within else observation
        if observation.is_whole_s and -SECOND_NS < after_ns < 0 and not epoch.is_whole_s:
            return msgspec.structs.replace(observation, time_ns=epoch.time_ns)
        if (
            epoch.is_whole_s
            and 0 < after_ns < SECOND_NS
            and observation.key not in epoch.timed_keys
        ):
            epoch.time_ns = time_ns
        return observation

    def _is_to_wait(self, observation: Observation) -> bool:
        """Whether it cannot be known yet to which epoch a sentence belongs."""
        if observation.time_ns is None:
            waits = bool(self._held) and observation.kind not in POSITION_KINDS
        else:
            waits = observation.kind in COMPANIONS and (
                self._first is None or self._is_next(observation.time_ns)
            )
        return waits and len(self._held) < HELD_MAX

    def _placed(self, observation: Observation) -> tuple[list[Observation], list[Epoch]]:
        """The sentences that lead a timed one's epoch, or the epochs that they end."""
        time_ns, held_ns = observation.time_ns, self._held[0].time_ns
        leads = time_ns is not None and held_ns is not None and _is_same(time_ns, held_ns)
        if not leads:
            return [], self._released()
        held, self._held = self._held, []
        return held, []

    def _released(self) -> list[Epoch]:
        """Epochs that the waiting sentences end, which belong to the current one."""
        held, self._held = self._held, []
        complete: list[Epoch] = []
        for each in held:
            complete += self._take(_untimed(each))
        return complete

    def _is_straggler(self, observation: Observation) -> bool:
        """Whether it is of an epoch that is complete and no more the current one."""
        time_ns, newest_ns = observation.time_ns, self._newest_ns
        if time_ns is None or newest_ns is None or time_ns > newest_ns:
            return False
        if not self._is_next(time_ns) or not 0 <= _back_ns(time_ns, newest_ns) <= LATE_MAX_NS:
            return False
        told = next((told for told in self._told if _is_same(told.time_ns, time_ns)), None)
        return told is not None and observation.key not in told.keys

    def _is_next(self, time_ns: int) -> bool:
        """Whether a time is another than the current cycle's."""
        if self._first is None or self._first.time_ns is None:
            return False
        return not _is_same(time_ns, self._first.time_ns)

    def _turn_to(self, time_ns: int) -> list[Epoch]:
        """Epochs that end where the cycle of another time begins or goes on."""
        current_ns = self._first.time_ns if self._first else None
        aside, aside_ns = self._aside, self._aside.time_ns if self._aside else None
        if aside is None or aside_ns is None:
            if current_ns is not None and 0 < time_ns - current_ns <= LATE_MAX_NS:
                self._period_ns = time_ns - current_ns
                return self._end_cycle()
            if current_ns is not None and self._is_early(time_ns, current_ns):
                self._set_aside()
                return []
            return self._end_cycle()
        complete = self._end_cycle()
        if _is_same(time_ns, aside_ns):
            self._first, self._aside = aside, None
            self._order.begin(aside.first_key)
        elif _back_ns(time_ns, aside_ns) < 0:
            self._aside = None
            complete += self._told_now(aside)
        return complete

    def _set_aside(self) -> None:
        if self._first and self._second:
            self._first.merge(self._second)
        self._aside, self._first, self._second = self._first, None, None
        self._order.skip_cycle()

    def _is_early(self, time_ns: int, current_ns: int) -> bool:
        """Whether a time is of an epoch that came after a later one which is not complete."""
        return (
            not self._ended
            and 0 < _back_ns(time_ns, current_ns) <= LATE_MAX_NS
            and not any(_is_same(told.time_ns, time_ns) for told in self._told)
        )

    def _take(self, observation: Observation) -> list[Epoch]:
        """Epochs that a sentence of the current cycle ends."""
        epoch, order = self._epoch_of(observation), self._order
        epoch.add(observation)
        order.note(observation.key)
        first = self._first
        if first is None:
            return []
        if not self._ended and order.at_end(first.timed_keys):
            return self._finish_current()
        return self._repeated(first, epoch) if epoch is self._second else []

    def _finish_current(self) -> list[Epoch]:
        if self._first is None or self._ended:
            return []
        self._ended = True
        if self._second:
            self._first.merge(self._second)
            self._second = None
        return self._told_now(self._first)

    def _told_now(self, epoch: Epoch) -> list[Epoch]:
        """A complete epoch, remembered, where it tells of a position."""
        if not epoch.has_position:
            return []
        time_ns, newest_ns = epoch.time_ns or 0, self._newest_ns
        self._told.append(Told(time_ns, epoch.timed_keys))
        if (
            newest_ns is None
            or time_ns > newest_ns
            or not 0 <= _back_ns(time_ns, newest_ns) <= LATE_MAX_NS
        ):
            self._newest_ns = time_ns
        return [epoch]

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
        complete = self._finish_current()
        return [*complete, second] if second.repeat else complete

    def _end_cycle(self) -> list[Epoch]:
        complete = self._finish_current()
        if self._first and self._first.has_position:
            self._order.end_cycle(self._first.timed_keys)
        else:
            self._order.skip_cycle()
        self._first = self._second = None
        self._ended = False
        return complete


def _untimed(observation: Observation) -> Observation:
    return msgspec.structs.replace(observation, time_ns=None)


def _is_same(time_ns: int, other_ns: int) -> bool:
    return abs(time_ns - other_ns) <= SAME_TIME_NS


def _back_ns(time_ns: int, from_ns: int) -> int:
    """How far a time of day lies before another, over midnight too."""
    return from_ns - nearest_ns(time_ns, from_ns)
