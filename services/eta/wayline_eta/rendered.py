"""Answers as bytes, each made once a tick however many ask for it."""

from collections.abc import Callable, Hashable
from typing import NamedTuple

import msgspec

from wayline.digits import rounded
from wayline.view import Clock

TICK_NS = 1_000_000_000
"""Ages and seconds to go are counted on at least so often."""
MANY_NS = 100_000_000
"""What is told of many vehicles changes all the time; it is made anew so often at most."""
ANSWERS_MAX = 4_096
"""Different questions; where there are more, all begin anew."""


class Made(NamedTuple):
    """An answer, what it rests on, and when it was made."""

    basis: Hashable
    at_ns: int
    body: bytes


class Rendered:
    """Used by one thread: the server's. `clock_ns` only goes forward."""

    def __init__(self, clock_ns: Clock) -> None:
        self._clock_ns = clock_ns
        self._made: dict[Hashable, Made] = {}

    def of_one(
        self, question: Hashable, basis: Hashable, make: Callable[[], msgspec.Struct]
    ) -> bytes:
        """The answer that was made on the same basis within the last tick, else a new one."""
        made, now_ns = self._made.get(question), self._clock_ns()
        if made is not None and made.basis == basis and now_ns - made.at_ns < TICK_NS:
            return made.body
        body = msgspec.json.encode(rounded(make()))
        if len(self._made) >= ANSWERS_MAX:
            self._made.clear()
        self._made[question] = Made(basis, now_ns, body)
        return body

    def of_many(self, question: Hashable, make: Callable[[], msgspec.Struct]) -> bytes:
        """The answer that was made within the last tenth of a second, else a new one."""
        return self.of_one(question, self._clock_ns() // MANY_NS, make)
