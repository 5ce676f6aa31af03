"""Times pieces of work in turns, so that a slow moment of the machine strikes all of them."""

import time
from collections.abc import Callable, Mapping

Work = Callable[[], object]
Say = Callable[[str], None]


def in_turns(works: Mapping[str, Work], rounds: int, say: Say) -> dict[str, list[float]]:
    """CPU seconds of each round of each work; one round before them warms up and is not kept."""
    seconds: dict[str, list[float]] = {name: [] for name in works}
    for number in range(rounds + 1):
        say(f"round {number} of {rounds}")
        # every other round backwards: nobody always follows the same neighbour
        for name in list(works)[:: 1 if number % 2 else -1]:
            spent_s = cpu_s(works[name])
            if number:
                seconds[name].append(spent_s)
    return seconds


def cpu_s(work: Work) -> float:
    """CPU seconds of a piece of work."""
    # of this thread alone: what else the machine does is not counted
    started_s = time.thread_time()
    work()
    return time.thread_time() - started_s
