"""Pure: how well a vehicle is followed along its trip and its arrivals are told, against the truth.

A second counts where the vehicle is on a trip and that trip is told. Predictions are judged by the
ETA Accuracy Benchmark: by the actual time to the arrival, in bounds that forgive late vehicles.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import msgspec
import numpy as np
from numpy.typing import NDArray

from wayline.messages import Arrivals, Progress, StopEvent
from wayline_evaluation.estimates import Floats

BUCKETS_MIN = (3.0, 6.0, 10.0, 15.0)
"""Minutes ahead, up to each."""
BOUNDS_S = ((-30.0, 90.0), (-60.0, 150.0), (-60.0, 210.0), (-90.0, 270.0))
"""Of actual minus predicted, in each."""
SECOND_NS = 1_000_000_000

Visited = Mapping[tuple[str, str], float]
"""When the vehicle came to a stop of a trip, Unix seconds, by trip_id and stop_id."""


class ArrivalScore(msgspec.Struct, frozen=True, kw_only=True):
    """One drive, or several; null where there is nothing to judge."""

    drive: str
    seconds: int
    """On a trip that was told."""
    along_p50_m: float | None
    along_p95_m: float | None
    """Off the place along the trip's line."""
    told_share: float | None
    """Of the seconds on the route: arrivals were told."""
    stale_share: float | None
    visits: int
    """Stops that the vehicle came to."""
    events: int
    """Of them, those with an arrival or a pass told."""
    event_p50_s: float | None
    event_p95_s: float | None
    """Off the instant that the vehicle came."""
    benchmark_shares: tuple[float | None, ...]
    """Of predictions in the Benchmark's bounds, at 0-3, 3-6, 6-10 and 10-15 minutes."""
    within_share: float | None
    """Came between the 10 and the 90 % quantile."""
    ghost_share: float | None
    """Of the stops told for a trip: the vehicle never came to them."""


class ArrivalReport(msgspec.Struct, frozen=True, kw_only=True):
    """What `wayline evaluate eta --json` writes."""

    scores: tuple[ArrivalScore, ...]
    pooled: ArrivalScore


@dataclass(frozen=True, slots=True)
class AlongTruth:
    """Where a vehicle was along its trips; shape (n,) each, times ascending, whole seconds."""

    times_s: Floats
    trips: NDArray[np.str_]
    """Empty while it runs none."""
    alongs_m: Floats
    """NaN there."""


@dataclass(frozen=True, slots=True)
class ArrivalRun:
    """What is judged of a drive."""

    drive: str
    along_errors_m: Floats
    on_route: int
    told: int
    stale: int
    arrivals: int
    visits: int
    event_errors_s: Floats
    ahead_min: Floats
    errors_s: Floats
    within: NDArray[np.bool_]
    promised: int
    ghosts: int


def arrival_run(
    drive: str,
    truth: AlongTruth,
    visited: Visited,
    *,
    progress: Sequence[Progress],
    arrivals: Sequence[Arrivals],
    events: Iterable[StopEvent],
) -> ArrivalRun:
    """Compare what was told of a drive with what happened."""
    told = {one.t_ns for one in arrivals if one.stops}
    on_route = [one.t_ns for one in progress if one.on_route]
    predictions = np.array(list(_predictions(visited, arrivals)), np.float64).reshape(-1, 3)
    promised = {
        (stop.trip_id or one.trip_id or "", stop.stop_id)
        for one in arrivals
        if one.trip_id is not None
        for stop in one.stops
    }
    return ArrivalRun(
        drive=drive,
        along_errors_m=_along_errors_m(truth, progress),
        on_route=len(on_route),
        told=sum(t_ns in told for t_ns in on_route),
        stale=sum(one.stale for one in arrivals),
        arrivals=len(arrivals),
        visits=len(visited),
        event_errors_s=_event_errors_s(visited, events),
        ahead_min=predictions[:, 0],
        errors_s=predictions[:, 1],
        within=predictions[:, 2] > 0.0,
        promised=len(promised),
        ghosts=len(promised - visited.keys()),
    )


def _along_errors_m(truth: AlongTruth, progress: Iterable[Progress]) -> Floats:
    rows = {round(float(t_s)): row for row, t_s in enumerate(truth.times_s)}
    errors_m = []
    for one in progress:
        row = rows.get(one.t_ns // SECOND_NS)
        if row is not None and one.trip_id is not None and truth.trips[row] == one.trip_id:
            errors_m.append(abs(one.distance_m - float(truth.alongs_m[row])))
    return np.array(errors_m)


def _event_errors_s(visited: Visited, events: Iterable[StopEvent]) -> Floats:
    first: dict[tuple[str, str], float] = {}
    for event in events:
        key = (event.trip_id or "", event.stop_id)
        if event.kind in {"arrived", "passed"} and key in visited:
            first.setdefault(key, abs(event.t_ns / SECOND_NS - visited[key]))
    return np.array(list(first.values()))


def _predictions(
    visited: Visited, arrivals: Iterable[Arrivals]
) -> Iterable[tuple[float, float, bool]]:
    """Minutes ahead, actual minus predicted, and whether it lay within the quantiles."""
    for one in arrivals:
        for stop in one.stops:
            came_s = visited.get((one.trip_id or "", stop.stop_id))
            if came_s is None or stop.trip_id is not None:
                continue
            ahead_min = (came_s - one.t_ns / SECOND_NS) / 60.0
            if 0.0 <= ahead_min < BUCKETS_MIN[-1]:
                within = stop.early_ns <= came_s * SECOND_NS <= stop.late_ns
                yield ahead_min, came_s - stop.arrival_ns / SECOND_NS, within


def score(run: ArrivalRun) -> ArrivalScore:
    """The run in numbers."""
    bucket = np.searchsorted(BUCKETS_MIN, run.ahead_min, side="right")
    shares = []
    for at, (low_s, high_s) in enumerate(BOUNDS_S):
        errors_s = run.errors_s[bucket == at]
        good = (errors_s >= low_s) & (errors_s <= high_s)
        shares.append(_share(int(np.count_nonzero(good)), len(errors_s)))
    return ArrivalScore(
        drive=run.drive,
        seconds=len(run.along_errors_m),
        along_p50_m=_quantile(run.along_errors_m, 0.5),
        along_p95_m=_quantile(run.along_errors_m, 0.95),
        told_share=_share(run.told, run.on_route),
        stale_share=_share(run.stale, run.arrivals),
        visits=run.visits,
        events=len(run.event_errors_s),
        event_p50_s=_quantile(run.event_errors_s, 0.5),
        event_p95_s=_quantile(run.event_errors_s, 0.95),
        benchmark_shares=tuple(shares),
        within_share=_share(int(np.count_nonzero(run.within)), len(run.within)),
        ghost_share=_share(run.ghosts, run.promised),
    )


def pooled(runs: Sequence[ArrivalRun]) -> ArrivalScore:
    """All drives as one."""
    whole = ArrivalRun(
        drive="all",
        along_errors_m=np.concatenate([run.along_errors_m for run in runs]),
        on_route=sum(run.on_route for run in runs),
        told=sum(run.told for run in runs),
        stale=sum(run.stale for run in runs),
        arrivals=sum(run.arrivals for run in runs),
        visits=sum(run.visits for run in runs),
        event_errors_s=np.concatenate([run.event_errors_s for run in runs]),
        ahead_min=np.concatenate([run.ahead_min for run in runs]),
        errors_s=np.concatenate([run.errors_s for run in runs]),
        within=np.concatenate([run.within for run in runs]),
        promised=sum(run.promised for run in runs),
        ghosts=sum(run.ghosts for run in runs),
    )
    return score(whole)


def _share(part: int, whole: int) -> float | None:
    return part / whole if whole else None


def _quantile(values: Floats, quantile: float) -> float | None:
    return float(np.quantile(values, quantile)) if len(values) else None
