"""Pure: by how much the arrival at the destination was mispredicted at each stop before it.

As papers/000 has it in tables 2 to 4: a trial is a lap of a loop, from its first stop to that stop
again, or a trip to its last stop. When the vehicle comes to a stop, what is told then of the
destination is compared with when it comes there.
"""

from collections import defaultdict
from collections.abc import Iterable, Sequence
from typing import NamedTuple

import msgspec
import numpy as np

from wayline.errors import InputError
from wayline.messages import Arrivals, StopEvent

CAME = ("arrived", "passed")
TOLD_WITHIN_NS = 60_000_000_000
"""What is told later is not what was told at the stop."""
ANOTHER_NS = 6 * 3_600_000_000_000
"""A trip of the same name so much later is another day's."""


class Visit(NamedTuple):
    """A vehicle at a stop."""

    t_ns: int
    trip_id: str | None
    stop_id: str


class Trial(NamedTuple):
    """One way to a destination: the stops before it, then the arrival there."""

    name: str
    route_id: str
    before: tuple[Visit, ...]
    end: Visit


class TrialErrors(msgspec.Struct, frozen=True, kw_only=True):
    """Of one trial, at the stops before its destination."""

    trial: str
    route_id: str
    stops: tuple[str, ...]
    errors_s: tuple[float, ...]
    """When it came to the destination minus when it was said to."""
    mean_s: float
    std_s: float | None
    """Of the sample; null of a single one."""


class StopErrors(msgspec.Struct, frozen=True, kw_only=True):
    """Of all trials, at one stop."""

    route_id: str
    stop_id: str
    count: int
    mean_s: float
    std_s: float | None


class Statistics(NamedTuple):
    """Of a sample."""

    mean: float
    std: float | None


def statistics(values: Sequence[float]) -> Statistics:
    """Mean and standard deviation of a sample; one alone has none."""
    std = float(np.std(values, ddof=1)) if len(values) > 1 else None
    return Statistics(float(np.mean(values)), std)


def trials_of(drive: str, events: Iterable[StopEvent]) -> list[Trial]:
    """The whole trials of a drive, in the order in which they ended."""
    ways: defaultdict[tuple[str, str | None], list[StopEvent]] = defaultdict(list)
    for event in events:
        if event.kind in CAME or (event.kind == "departed" and event.trip_id is not None):
            ways[event.route_id, event.trip_id].append(event)
    found = [
        trial
        for (_, trip_id), way in ways.items()
        for trial in (_laps(drive, way) if trip_id is None else _trips(drive, way))
    ]
    return sorted(found, key=lambda trial: trial.end.t_ns)


def trials_from(lap: int, trials: Sequence[Trial], drive: str) -> Sequence[Trial]:
    """Without those before the first, second, ... lap or trip. Raises InputError for none left."""
    if lap > max(len(trials), 1):
        mend = "give an earlier lap, or name a longer drive"
        raise InputError("--from-lap", f"{drive} has {len(trials)} laps or trips", mend)
    return trials[lap - 1 :]


def _laps(drive: str, way: Sequence[StopEvent]) -> Iterable[Trial]:
    """From the first stop to it again; where it is come to once, to the last one."""
    first = min(event.stop_sequence for event in way)
    starts = [at for at, event in enumerate(way) if event.stop_sequence == first]
    ends = starts[1:] or [len(way) - 1]
    for number, (start, end) in enumerate(zip(starts, ends, strict=False), start=1):
        if end > start:
            route_id, before = way[start].route_id, _once(way[start:end])
            yield Trial(f"{drive} {number}", route_id, before, _visit(way[end]))


def _trips(drive: str, way: Sequence[StopEvent]) -> Iterable[Trial]:
    """Each day's run of a trip."""
    gaps_ns = np.diff([event.t_ns for event in way])
    parts = np.split(np.arange(len(way)), np.flatnonzero(gaps_ns > ANOTHER_NS) + 1)
    for part in parts:
        run = [way[at] for at in part]
        came = [event for event in run if event.kind in CAME]
        if came and len(before := _once([each for each in run if each.t_ns < came[-1].t_ns])):
            name = f"{drive} {came[-1].trip_id}"
            yield Trial(name, came[-1].route_id, before, _visit(came[-1]))


def _once(events: Sequence[StopEvent]) -> tuple[Visit, ...]:
    """The first that is known of each stop."""
    first: dict[str, Visit] = {}
    for event in events:
        first.setdefault(event.stop_id, _visit(event))
    return tuple(first.values())


def _visit(event: StopEvent) -> Visit:
    return Visit(event.t_ns, event.trip_id, event.stop_id)


def errors_of(trial: Trial, told: Sequence[Arrivals]) -> TrialErrors | None:
    """What was told at each stop of the destination; None where nothing was."""
    times_ns = np.array([arrivals.t_ns for arrivals in told], dtype=np.int64)
    stops, errors_s = [], []
    for visit in trial.before:
        at = int(np.searchsorted(times_ns, visit.t_ns))
        arrival_ns = _told_of_end(trial, visit, told[at:])
        if arrival_ns is not None:
            stops.append(visit.stop_id)
            errors_s.append((trial.end.t_ns - arrival_ns) * 1e-9)
    if not errors_s:
        return None
    mean_s, std_s = statistics(errors_s)
    return TrialErrors(
        trial=trial.name,
        route_id=trial.route_id,
        stops=tuple(stops),
        errors_s=tuple(errors_s),
        mean_s=mean_s,
        std_s=std_s,
    )


def _told_of_end(trial: Trial, visit: Visit, told: Iterable[Arrivals]) -> int | None:
    """The first arrival at the destination that is told from a visit on."""
    middle_ns = (visit.t_ns + trial.end.t_ns) // 2
    for arrivals in told:
        if arrivals.t_ns > min(visit.t_ns + TOLD_WITHIN_NS, trial.end.t_ns):
            return None
        for stop in arrivals.stops:
            key = stop.trip_id or arrivals.trip_id, stop.stop_id
            # at the first stop of a lap eta may not have seen yet that it has come
            is_passed = visit.stop_id == stop.stop_id and stop.arrival_ns < middle_ns
            if key == (trial.end.trip_id, trial.end.stop_id) and not is_passed:
                return stop.arrival_ns
    return None


def by_stop(trials: Iterable[TrialErrors]) -> list[StopErrors]:
    """Of all trials at each stop, in the order in which stops are come to."""
    errors_s: defaultdict[tuple[str, str], list[float]] = defaultdict(list)
    for trial in trials:
        for stop_id, error_s in zip(trial.stops, trial.errors_s, strict=True):
            errors_s[trial.route_id, stop_id].append(error_s)
    return [
        StopErrors(
            route_id=route_id,
            stop_id=stop_id,
            count=len(errors),
            mean_s=statistics(errors).mean,
            std_s=statistics(errors).std,
        )
        for (route_id, stop_id), errors in errors_s.items()
    ]
