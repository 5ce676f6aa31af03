"""Pure: times far ahead of all others, held until enough of them agree (SPEC section 3).

A receiver's week counter, a row typed by hand, a logger's clock before it was set: for a while they
tell a time hours or years ahead, and what believed them once would believe nothing else again. A
pause looks the same at first, but its times stay.
"""

from collections import deque
from collections.abc import Iterable, Iterator
from functools import reduce
from typing import Generic, TypeVar

from wayline.cadence import REMEMBERED, Cadence

SECOND_NS = 1_000_000_000
AHEAD_NS = 60 * SECOND_NS
"""A time further beyond those known is doubted."""
AGREEING = 10
"""So many that follow each other are believed ..."""
AGREEING_FOR_NS = 10 * SECOND_NS
"""... once they span this."""
MISSED = 3
"""Reports in a row that a source may leave out: that is no time ahead."""
SELDOM_S = 120.0
"""Between reports of a normal source at most; assumed of one that has not been heard twice."""
PAUSE_MAX_NS = 86_400 * SECOND_NS
"""Doubted times further before those that are believed were no pause, but wrong as well."""
BREAK_MAX_NS = 1_800 * SECOND_NS
"""Where input ends before enough agree: clocks are wrong by whole hours at least, so what follows
a shorter break is taken for right, ..."""
BREAK_AGREEING = 2
"""... but not a single one."""
HELD_MAX = 2_000
"""By default; a clock that stands would be waited for without end."""

Item = TypeVar("Item")
Timed = tuple[int, Item]
"""What was told, and of when (Unix ns)."""


class TimesAhead(Generic[Item]):
    """Passes on what is told of one clock, in order, and holds what it tells of a time ahead.

    What is held goes on once `AGREEING` over `AGREEING_FOR_NS` follow each other; it is dropped and
    counted when the clock returns before that. A receipt that bears a time out (within `AHEAD_NS`)
    confirms it at once, one that is far behind it doubts the first time of all. Where reading on
    costs nothing, in a recording, the beginning is doubted in any case (`doubts_start`): the times
    that follow tell whether it was right. `held_max`: so many are believed whatever they span.
    """

    def __init__(self, *, doubts_start: bool = False, held_max: int = HELD_MAX) -> None:
        self._doubts_start = doubts_start
        self._held_max = held_max
        self._known: deque[int] = deque(maxlen=REMEMBERED + 1)
        """The last times that were believed, rising."""
        self._runs: list[list[Timed[Item]]] = []
        """What is held; in a run times follow each other, between runs they leap ahead."""
        self._held = 0
        self._odd: Timed[Item] | None = None
        """Far behind a beginning that is held: alone it is nonsense, with another one a return."""
        self.dropped = 0
        """How many items were of a time that did not last."""

    @property
    def known_ns(self) -> int | None:
        """The latest time that was believed."""
        return self._known[-1] if self._known else None

    def take(self, t_ns: int, item: Item, receipt_ns: int | None = None) -> list[Timed[Item]]:
        """What can be told now: nothing, the item, or with it all that it confirms."""
        if receipt_ns is None and not self._known and self._runs:
            return self._begin(t_ns, item)
        return self._go_on(t_ns, item, receipt_ns)

    def _begin(self, t_ns: int, item: Item) -> list[Timed[Item]]:
        """One more of a beginning that is held; a single one far behind the rest costs itself."""
        odd, self._odd = self._odd, None
        is_behind = t_ns < self._runs[-1][-1][0] - AHEAD_NS
        if odd is None and is_behind:
            self._odd = (t_ns, item)
            return []
        if odd is not None and is_behind:
            self._hold(*odd)
        elif odd is not None:
            self.dropped += 1
        return self._go_on(t_ns, item, None)

    def _go_on(self, t_ns: int, item: Item, receipt_ns: int | None) -> list[Timed[Item]]:
        known = self._known
        if not self._runs and known and t_ns <= known[-1] + AHEAD_NS:
            if t_ns > known[-1]:
                known.append(t_ns)
            return [(t_ns, item)]
        if not self._is_ahead(t_ns, receipt_ns):
            return self._returned(t_ns, item)
        self._hold(t_ns, item)
        return self._believed(self._emptied()) if self._agree() else []

    def finish(self) -> list[Timed[Item]]:
        """At the end of input: the best of a beginning in doubt, and what follows short breaks."""
        if self._odd is not None:
            self._odd = None
            self.dropped += 1
        runs = self._emptied()
        told: list[Timed[Item]] = []
        if runs and not self._known:
            longest = max(range(len(runs)), key=lambda at: len(runs[at]))
            told = self._believed(runs[: longest + 1])
            runs = runs[longest + 1 :]
        while runs and len(runs[0]) >= BREAK_AGREEING:
            if runs[0][0][0] - self._known[-1] > BREAK_MAX_NS:
                break
            told += self._told(runs.pop(0))
        self._drop(runs)
        return told

    def _is_ahead(self, t_ns: int, receipt_ns: int | None) -> bool:
        if receipt_ns is not None and abs(receipt_ns - t_ns) <= AHEAD_NS:
            return False
        if self._known:
            return t_ns - self._known[-1] > reach_ns(self._known)
        return self._doubts_start or (receipt_ns is not None and t_ns - receipt_ns > AHEAD_NS)

    def _returned(self, t_ns: int, item: Item) -> list[Timed[Item]]:
        """What is believed, and of what was held that which is no later."""
        held = [timed for run in self._emptied() for timed in run]
        told = [timed for timed in held if timed[0] <= t_ns]
        self.dropped += len(held) - len(told)
        return self._told([*told, (t_ns, item)])

    def _hold(self, t_ns: int, item: Item) -> None:
        runs = self._runs
        while runs and runs[-1][-1][0] > t_ns + AHEAD_NS:
            runs[-1].pop()
            self._held -= 1
            self.dropped += 1
            if not runs[-1]:
                runs.pop()
        if not runs or self._leaps(t_ns, runs[-1]):
            runs.append([])
        runs[-1].append((t_ns, item))
        self._held += 1

    def _emptied(self) -> list[list[Timed[Item]]]:
        """What was held, which is held no more."""
        runs, self._runs, self._held = self._runs, [], 0
        return runs

    def _leaps(self, t_ns: int, run: list[Timed[Item]]) -> bool:
        """Whether a time is too far ahead of a run's to follow it."""
        after_ns = t_ns - run[-1][0]
        if after_ns <= AHEAD_NS:
            return False
        latest = [*self._known, *(held_ns for held_ns, _ in run[-REMEMBERED - 1 :])]
        return after_ns > reach_ns(latest[-REMEMBERED - 1 :])

    def _agree(self) -> bool:
        run = self._runs[-1]
        if len(run) >= AGREEING and run[-1][0] - run[0][0] >= AGREEING_FOR_NS:
            return True
        return self._held >= self._held_max

    def _believed(self, runs: list[list[Timed[Item]]]) -> list[Timed[Item]]:
        """The last of some runs, and those before it, as far as they are near enough."""
        begins_ns = runs[-1][0][0]
        far = [run for run in runs if begins_ns - run[-1][0] > PAUSE_MAX_NS]
        self._drop(far)
        # times rise from run to run, so the far ones are the first
        return self._told([timed for run in runs[len(far) :] for timed in run])

    def _told(self, believed: list[Timed[Item]]) -> list[Timed[Item]]:
        known = self._known
        for t_ns, _ in believed:
            if not known or t_ns > known[-1]:
                known.append(t_ns)
        return believed

    def _drop(self, runs: Iterable[list[Timed[Item]]]) -> None:
        self.dropped += sum(map(len, runs))


def reach_ns(instants: Iterable[int]) -> int:
    """How far ahead of the last of some rising times (Unix ns) the next one may well be."""
    cadence = reduce(Cadence.noticed, instants, Cadence())
    usual_s = cadence.usual_s if cadence.intervals_ns else SELDOM_S
    return max(AHEAD_NS, MISSED * round(usual_s * SECOND_NS))


def believed(timed: Iterable[Timed[Item]], ahead: TimesAhead[Item]) -> Iterator[Item]:
    """A recording's items without those of a time that did not last."""
    for t_ns, item in timed:
        for _, told in ahead.take(t_ns, item):
            yield told
    for _, told in ahead.finish():
        yield told
