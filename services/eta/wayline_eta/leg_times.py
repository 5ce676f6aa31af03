"""Pure: what a vehicle took from stop to stop, and at each, by what it did at them."""

from typing import NamedTuple

from wayline.messages import StopEvent
from wayline_eta.legs import Leg, Legs


class Taken(NamedTuple):
    """What a vehicle took for a leg, and at the stop where that ends."""

    leg: Leg | None
    """None where the vehicle was not followed all the way from the stop before."""
    travel_s: float
    stop: int
    arrived_ns: int
    dwell_s: float
    """0 where it passed."""


class LegTimes:
    """Of one vehicle on one route, from its stop events in their order.

    `sequences` are the stops' numbers in the events.
    """

    def __init__(self, legs: Legs, sequences: list[int]) -> None:
        self._legs = legs
        self._stops = {sequence: stop for stop, sequence in enumerate(sequences)}
        self._left: tuple[int, int] | None = None
        """The stop that it left last, counted on over the laps, and when."""
        self._at: tuple[int, int] | None = None
        """The stop where it stands, counted so, and since when."""

    def stands(self, t_ns: int) -> tuple[int, float] | None:
        """The stop where it stands, and for how long, in seconds; None under way."""
        if self._at is None:
            return None
        number, since_ns = self._at
        return number % len(self._stops), max(t_ns - since_ns, 0) * 1e-9

    def gone_s(self, stop: int, t_ns: int) -> float | None:
        """Seconds under way to a stop; None where nobody saw it leave the one before."""
        if self._at is not None or self._left is None:
            return None
        number, left_ns = self._left
        is_next = (number + 1) % len(self._stops) == stop
        return max(t_ns - left_ns, 0) * 1e-9 if is_next else None

    def observe(self, event: StopEvent) -> Taken | None:
        """Take what has happened; what it took, once a stop is over."""
        stop = self._stops.get(event.stop_sequence)
        if stop is None:
            return None
        number = event.lap * len(self._stops) + stop
        if event.kind == "arrived":
            self._at = number, event.t_ns
            return None
        if event.kind == "skipped":
            self._at = self._left = None
            return None
        arrived_ns = event.t_ns
        if event.kind == "departed":
            if self._at is None or self._at[0] != number:
                self._left = number, event.t_ns
                return None
            arrived_ns = self._at[1]
        before, self._left, self._at = self._left, (number, event.t_ns), None
        leg, travel_s = None, 0.0
        if before is not None and before[0] == number - 1:
            leg = self._legs.to(stop)
            travel_s = (arrived_ns - before[1]) * 1e-9
        return Taken(leg, travel_s, stop, arrived_ns, (event.t_ns - arrived_ns) * 1e-9)
