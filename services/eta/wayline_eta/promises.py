"""Pure: what was told of a vehicle's arrivals, remembered until each has come, and scored then.

One prediction a minute of each stop is remembered, for half an hour ahead. When the vehicle comes,
all that were made of that arrival are scored; those of a stop that it leaves out, or does not come
to within half an hour of when it was due, are ghosts.
"""

from collections import defaultdict
from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import msgspec

from wayline.messages import Arrivals, Progress, StopEvent
from wayline_eta.records import Scored
from wayline_eta.scores import MBTA_SPANS_MIN, Prediction, Sums, sums_of

EVERY_NS = 60_000_000_000
AHEAD_NS = round(MBTA_SPANS_MIN[-1][1]) * EVERY_NS
"""Farther ahead nothing is scored."""
OVERDUE_NS = 30 * EVERY_NS
NEVER_NS = 1 << 62
NOTHING_CAME = sums_of(())
"""Of most minutes."""
PROMISES_MAX = 2_000
"""Of one vehicle; the oldest are forgotten first."""

StopKey = tuple[str | None, str]
"""Trip (None on a route without, and where it is not certain) and stop."""


class Promise(NamedTuple):
    """Of one arrival, as it was told."""

    route_id: str
    made_ns: int
    arrival_ns: int
    early_ns: int
    late_ns: int

    def came(self, t_ns: int | None) -> Prediction:
        """How it turned out: when the vehicle came, None where it never did."""
        made_ns = self.made_ns
        instants_ns = self.arrival_ns, self.early_ns, self.late_ns
        predicted_s, early_s, late_s = ((each - made_ns) * 1e-9 for each in instants_ns)
        actual_s = None if t_ns is None else (t_ns - made_ns) * 1e-9
        return Prediction(predicted_s, early_s, late_s, actual_s)


@dataclass(slots=True)
class Seen:
    """Of a vehicle on one route."""

    arrivals: int = 0
    on_route_s: int = 0
    told_s: int = 0


class Promises:
    """Of one vehicle, with what has been scored since that was taken last."""

    def __init__(self) -> None:
        self._made: dict[StopKey, list[Promise]] = {}
        self._came: defaultdict[str, list[Prediction]] = defaultdict(list)
        self._seen: defaultdict[str, Seen] = defaultdict(Seen)
        self._overdue_ns = NEVER_NS
        """None of them is before this."""
        self._minute = 0
        self._standing: StopKey | None = None
        """The stop whose arrival has been scored and where the vehicle has not left yet."""

    def note(self, progress: Progress | None, arrivals: Arrivals) -> None:
        """Take what is told at one second."""
        is_told = bool(arrivals.stops) and not arrivals.stale
        if progress is not None and progress.on_route:
            seen = self._seen[progress.route_id]
            seen.on_route_s += 1
            seen.told_s += is_told
        minute = arrivals.t_ns // EVERY_NS
        if is_told and minute != self._minute:
            self._minute = minute
            self._promise(arrivals)

    def happened(self, event: StopEvent) -> None:
        """Take what the vehicle did at a stop."""
        key = event.trip_id, event.stop_id
        if event.kind == "skipped":
            self._end(event, None)
        elif event.kind != "departed" or key != self._standing:
            # a departure tells of an arrival only where the trip begins: nobody saw it come
            if event.kind != "departed":
                self._seen[event.route_id].arrivals += 1
            self._end(event, event.t_ns)
        self._standing = key if event.kind == "arrived" else None

    def take(self, t_ns: int) -> list[Scored]:
        """What has been scored since the last time, at a whole minute or at the end."""
        self._give_up(t_ns)
        scored = [
            Scored(t_ns=t_ns, route_id=route_id, sums=self._sums(route_id))
            for route_id in sorted({*self._came, *self._seen})
        ]
        self._came.clear()
        self._seen.clear()
        return scored

    def _sums(self, route_id: str) -> Sums:
        seen = self._seen[route_id]
        return msgspec.structs.replace(
            sums_of(came) if (came := self._came.get(route_id)) else NOTHING_CAME,
            arrivals=seen.arrivals,
            on_route_s=seen.on_route_s,
            told_s=seen.told_s,
        )

    def _promise(self, arrivals: Arrivals) -> None:
        for stop in arrivals.stops:
            if stop.arrival_ns < arrivals.t_ns + AHEAD_NS:
                key = stop.trip_id or arrivals.trip_id, stop.stop_id
                instants_ns = stop.arrival_ns, stop.early_ns, stop.late_ns
                promise = Promise(arrivals.route_id, arrivals.t_ns, *instants_ns)
                self._made.setdefault(key, []).append(promise)
                self._overdue_ns = min(self._overdue_ns, promise.arrival_ns + OVERDUE_NS)
        self._forget(sum(map(len, self._made.values())) - PROMISES_MAX)

    def _forget(self, too_many: int) -> None:
        if too_many > 0:
            oldest_ns = sorted([each.made_ns for made in self._made.values() for each in made])
            last_ns = oldest_ns[too_many - 1]
            self._keep(lambda made: [each for each in made if each.made_ns > last_ns])

    def _end(self, event: StopEvent, came_ns: int | None) -> None:
        """Score what was told of a stop, but what was told after the vehicle had come.

        As long as it was not certain which trip the vehicle ran, none was named.
        """
        for key in dict.fromkeys(((event.trip_id, event.stop_id), (None, event.stop_id))):
            for promise in self._made.pop(key, ()):
                if came_ns is None or promise.made_ns <= came_ns:
                    self._came[event.route_id].append(promise.came(came_ns))

    def _give_up(self, t_ns: int) -> None:
        """What is long overdue never comes."""
        if t_ns <= self._overdue_ns:
            return
        due_ns = t_ns - OVERDUE_NS
        for made in self._made.values():
            for promise in [each for each in made if each.arrival_ns < due_ns]:
                self._came[promise.route_id].append(promise.came(None))
        self._keep(lambda made: [each for each in made if each.arrival_ns >= due_ns])
        soonest_ns = [min(each.arrival_ns for each in made) for made in self._made.values()]
        self._overdue_ns = min(soonest_ns, default=NEVER_NS - OVERDUE_NS) + OVERDUE_NS

    def _keep(self, kept_of: Callable[[list[Promise]], list[Promise]]) -> None:
        kept = {key: kept_of(made) for key, made in self._made.items()}
        self._made = {key: made for key, made in kept.items() if made}
