"""Pure: whether what a vehicle took is a breakdown, far beyond anything that is usual there.

A jam is traffic, which others meet too, and teaches; who takes five times as long as usual and five
minutes more has broken down, or its driver is away. Where that happens to one vehicle after the
other it is no breakdown any more but how things are there now, and is learned.
"""

from collections import defaultdict

TIMES, LONGER_S = 5.0, 300.0
"""Beyond so many times what is usual, and so much more."""
IN_A_ROW = 3
"""So many at one place, one after the other, are none."""


class Breakdowns:
    """Of all vehicles, by place: a leg or a stop."""

    def __init__(self) -> None:
        self._in_a_row: defaultdict[str, int] = defaultdict(int)

    def is_one(self, place: str, took_s: float, usual_s: float) -> bool:
        """Whether what was taken there is a breakdown; each is asked of once."""
        if took_s <= max(TIMES * usual_s, usual_s + LONGER_S):
            self._in_a_row.pop(place, None)
            return False
        self._in_a_row[place] += 1
        return self._in_a_row[place] < IN_A_ROW
