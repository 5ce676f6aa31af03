"""Pure: epochs that wait until their day is known."""

from collections import deque

from wayline_gps_ingest.dates import nearest_ns
from wayline_gps_ingest.epoch import Epoch
from wayline_gps_ingest.fields import SECOND_NS

WAIT_NS = 10 * SECOND_NS
"""Older epochs are of no use to anyone once their day is known."""
CAPACITY = 100


class WaitingRoom:
    """Holds epochs of unknown day, and invalid ones whose day no fix has confirmed.

    A receiver without a fix tells the time of its own clock, which may be decades off.
    """

    def __init__(self) -> None:
        self._epochs: deque[Epoch] = deque()
        self.dropped = 0
        """Epochs with a fix that were lost; one without a fix is no loss."""

    def __len__(self) -> int:
        return len(self._epochs)

    def hold(self, epoch: Epoch) -> None:
        """Keep an epoch; the oldest goes when there is no room."""
        if len(self._epochs) == CAPACITY:
            self._drop(self._epochs.popleft())
        self._epochs.append(epoch)

    def release(self, now_ns: int) -> list[tuple[Epoch, int]]:
        """Epochs of the last seconds before an instant whose day is known, and their instants."""
        recent: list[tuple[Epoch, int]] = []
        for epoch in self._epochs:
            t_ns = nearest_ns(epoch.time_ns or 0, now_ns)
            if 0 <= now_ns - t_ns <= WAIT_NS:
                recent.append((epoch, t_ns))
            else:
                self._drop(epoch)
        self._epochs.clear()
        return recent

    def release_unconfirmed(self) -> list[tuple[Epoch, int]]:
        """At the end of input: those that carry a day, taken at their word."""
        dated: list[tuple[Epoch, int]] = []
        for epoch in self._epochs:
            dated_ns = epoch.facts.get("dated_ns")
            if dated_ns is not None:
                dated.append((epoch, nearest_ns(epoch.time_ns or 0, dated_ns)))
            else:
                self._drop(epoch)
        self._epochs.clear()
        return dated

    def _drop(self, epoch: Epoch) -> None:
        self.dropped += epoch.is_valid
