"""Pure: which processes to start, end or kill, and when. Time is given, nothing is run here."""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum, auto
from typing import NamedTuple

FIRST_DELAY_S = 0.2
LONGEST_DELAY_S = 5.0
STEADY_S = 10.0
"""A process that lived so long starts again after the first delay."""
GRACE_S = 5.0
"""What a process gets to end after SIGTERM before it is killed."""
NEEDS_MENDING = 2
"""The status of a process whose input or configuration somebody has to mend."""


class Action(Enum):
    """What to do to a process."""

    START = auto()
    TERMINATE = auto()
    KILL = auto()


class Order(NamedTuple):
    """One thing to do now."""

    action: Action
    name: str


class State(Enum):
    """Where a process stands."""

    WAITING = auto()
    RUNNING = auto()
    ENDING = auto()
    KILLED = auto()
    DOWN = auto()
    """Left alone: started again, it would say the same again."""
    OVER = auto()


ALIVE = frozenset({State.RUNNING, State.ENDING, State.KILLED})


@dataclass(slots=True)
class Watched:
    """One process: its state and since or from when, and how long it waits before the next try."""

    state: State = State.WAITING
    changed_s: float = 0.0
    due_s: float = 0.0
    delay_s: float = FIRST_DELAY_S

    def turn(self, state: State, now_s: float) -> None:
        """Enter a state."""
        self.state, self.changed_s = state, now_s

    def fall(self, now_s: float) -> float:
        """Wait after an unasked end, longer each time that the process did not last; the delay."""
        if now_s - self.changed_s >= STEADY_S:
            self.delay_s = FIRST_DELAY_S
        delay_s = self.delay_s
        self.delay_s = min(2.0 * delay_s, LONGEST_DELAY_S)
        self.due_s = now_s + delay_s
        self.turn(State.WAITING, now_s)
        return delay_s


class Supervisor:
    """Keeps processes running; when stopped, ends the last stage first, each in reverse order.

    `stages` are names in the order of starting: what a stage needs is in the stages before it.
    Whoever carries out the orders says with `ended` what has ended; all times are of one
    monotonic clock, in seconds. What needs mending is left down; when that is all of a last
    stage, the rest is of no use and ends too.
    """

    def __init__(self, stages: Sequence[Sequence[str]]) -> None:
        self._stages = [tuple(stage) for stage in stages]
        self._watched = {name: Watched() for stage in self._stages for name in stage}
        self._stopping = False

    @property
    def is_over(self) -> bool:
        """Whether it was stopped and every process has ended."""
        return self._stopping and not any(w.state in ALIVE for w in self._watched.values())

    @property
    def down(self) -> list[str]:
        """What ended because it needs mending, in the order of starting."""
        return [name for name, watched in self._watched.items() if watched.state is State.DOWN]

    def stop(self) -> None:
        """From now on nothing starts and everything ends."""
        self._stopping = True

    def ended(self, name: str, status: int, now_s: float) -> float | None:
        """Take note that a process has ended; seconds until it starts again, None for never."""
        watched = self._watched[name]
        if status == NEEDS_MENDING:
            watched.turn(State.DOWN, now_s)
            self._stopping = self._stopping or set(self._stages[-1]) <= set(self.down)
            return None
        if self._stopping:
            watched.turn(State.OVER, now_s)
            return None
        return watched.fall(now_s)

    def orders(self, now_s: float) -> list[Order]:
        """What to do now; each order is given once."""
        if self._stopping:
            return self._endings(now_s)
        due = [n for n, w in self._watched.items() if w.state is State.WAITING and w.due_s <= now_s]
        for name in due:
            self._watched[name].turn(State.RUNNING, now_s)
        return [Order(Action.START, name) for name in due]

    def _endings(self, now_s: float) -> list[Order]:
        for stage in reversed(self._stages):
            alive = [name for name in reversed(stage) if self._watched[name].state in ALIVE]
            if alive:
                return [order for name in alive if (order := self._ending(name, now_s))]
        return []

    def _ending(self, name: str, now_s: float) -> Order | None:
        watched = self._watched[name]
        if watched.state is State.RUNNING:
            watched.turn(State.ENDING, now_s)
            return Order(Action.TERMINATE, name)
        if watched.state is State.ENDING and now_s - watched.changed_s >= GRACE_S:
            watched.turn(State.KILLED, now_s)
            return Order(Action.KILL, name)
        return None
