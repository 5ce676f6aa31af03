"""Pure: how good predicted arrivals were, by how far ahead they were made.

The error is when the vehicle came minus when it was said to. A range holds where it came within it.
Yardsticks, with the time to go in minutes: the ETA Accuracy Benchmark, by the actual time to go;
Cal-ITP's bounds, by the predicted one.
"""

from collections import defaultdict
from collections.abc import Iterable, Sequence
from typing import NamedTuple

import msgspec
import numpy as np
from numpy.typing import NDArray

from wayline.messages import Arrivals, StopEvent

SPANS_MIN = ((0.0, 3.0), (3.0, 6.0), (6.0, 10.0), (10.0, 15.0), (15.0, 30.0))
BENCHMARK_MIN = ((-0.5, 1.5), (-1.0, 2.5), (-1.0, 3.5), (-1.5, 4.5))
"""Of the first four spans; later ones have none."""
CAME = ("arrived", "passed")
GHOST_S = 600.0
"""An arrival that was due so long before the end, and has not come by then, never does."""

ARRIVING_S = 15.0
"""Who stands in the truth and who is seen to stand may be so far apart."""

StopKey = tuple[str | None, str]
"""Trip (None on a route without) and stop."""


class SpanScore(msgspec.Struct, frozen=True, kw_only=True):
    """Of the predictions so many minutes ahead; null where there are none."""

    from_min: float
    to_min: float
    count: int
    mean_s: float | None
    mean_absolute_s: float | None
    std_s: float | None
    benchmark_share: float | None
    """In the ETA Accuracy Benchmark's bounds; null beyond 15 minutes."""
    cal_itp_share: float | None
    held_share: float | None
    """Within the range from p10 to p90."""


class EtaScore(msgspec.Struct, frozen=True, kw_only=True):
    """One drive, or all together."""

    drive: str
    arrivals: int
    """Stops that the vehicle came to."""
    told_share: float | None
    """Of the seconds on the route, those with a prediction."""
    ghost_share: float | None
    """Of the predictions, those of arrivals that never came."""
    spans: tuple[SpanScore, ...]
    benchmark_share: float | None
    """The mean of the first four spans."""


class EtaReport(msgspec.Struct, frozen=True, kw_only=True):
    """What `wayline evaluate eta --json` writes."""

    scores: tuple[EtaScore, ...]
    pooled: EtaScore


class Prediction(NamedTuple):
    """One arrival as it was told once, and when it came; in seconds from when it was told."""

    predicted_s: float
    early_s: float
    late_s: float
    actual_s: float | None
    """None: it never came."""


class EtaRun(NamedTuple):
    """What is scored of one drive."""

    drive: str
    predictions: Sequence[Prediction]
    arrivals: int
    told_seconds: int
    seconds: int


def predictions_of(told: Iterable[Arrivals], events: Sequence[StopEvent]) -> list[Prediction]:
    """Each prediction with the first arrival at its stop after it; the drive's end cuts off."""
    instants = _instants(events)
    end_ns = max((event.t_ns for event in events), default=0)
    found = []
    for arrivals in told:
        if arrivals.stale:
            continue
        for stop in arrivals.stops:
            key = (stop.trip_id or arrivals.trip_id, stop.stop_id)
            later = instants.get(key, np.empty(0, dtype=np.int64))
            at = int(np.searchsorted(later, arrivals.t_ns))
            if at + 1 < len(later) and later[at] < arrivals.t_ns + ARRIVING_S * 1e9:
                # eta has seen it come already and tells of the next time
                at += bool(stop.arrival_ns > (later[at] + later[at + 1]) // 2)
            if at == len(later) and stop.arrival_ns + GHOST_S * 1e9 > end_ns:
                continue
            actual_s = None if at == len(later) else (int(later[at]) - arrivals.t_ns) * 1e-9
            instants_ns = stop.arrival_ns, stop.early_ns, stop.late_ns
            predicted_s, early_s, late_s = ((each - arrivals.t_ns) * 1e-9 for each in instants_ns)
            found.append(Prediction(predicted_s, early_s, late_s, actual_s))
    return found


def _instants(events: Iterable[StopEvent]) -> dict[StopKey, NDArray[np.int64]]:
    """When the vehicle came to each stop; to one where its trip began, when it left."""
    came: defaultdict[StopKey, list[int]] = defaultdict(list)
    left: defaultdict[StopKey, list[int]] = defaultdict(list)
    for event in events:
        if event.kind in CAME:
            came[event.trip_id, event.stop_id].append(event.t_ns)
        elif event.kind == "departed":
            left[event.trip_id, event.stop_id].append(event.t_ns)
    return {key: np.sort(np.array(times, np.int64)) for key, times in {**left, **came}.items()}


def scored(run: EtaRun) -> EtaScore:
    """Figures of one drive."""
    spans = tuple(_span(run.predictions, *span) for span in SPANS_MIN)
    shares = [each.benchmark_share for each in spans if each.benchmark_share is not None]
    ghosts = sum(each.actual_s is None for each in run.predictions)
    return EtaScore(
        drive=run.drive,
        arrivals=run.arrivals,
        told_share=run.told_seconds / run.seconds if run.seconds else None,
        ghost_share=ghosts / len(run.predictions) if run.predictions else None,
        spans=spans,
        benchmark_share=float(np.mean(shares)) if shares else None,
    )


def pooled(runs: Sequence[EtaRun]) -> EtaScore:
    """Figures of all drives together."""
    return scored(
        EtaRun(
            "all",
            [each for run in runs for each in run.predictions],
            sum(run.arrivals for run in runs),
            sum(run.told_seconds for run in runs),
            sum(run.seconds for run in runs),
        )
    )


def _span(predictions: Iterable[Prediction], from_min: float, to_min: float) -> SpanScore:
    rows = [
        (each.predicted_s, each.early_s, each.late_s, each.actual_s)
        for each in predictions
        if each.actual_s is not None and from_min <= each.actual_s / 60.0 < to_min
    ]
    if not rows:
        unknown = dict.fromkeys(SpanScore.__struct_fields__[3:])
        return SpanScore(from_min=from_min, to_min=to_min, count=0, **unknown)
    predicted_s, early_s, late_s, actual_s = np.array(rows, dtype=np.float64).T
    errors_s = actual_s - predicted_s
    ahead_min = np.maximum(predicted_s / 60.0, 0.0)
    is_cal_itp = (errors_s > -60.0 * np.log(ahead_min + 1.3)) & (
        errors_s < 60.0 * np.log(ahead_min + 1.5)
    )
    bounds = dict(zip(SPANS_MIN, BENCHMARK_MIN, strict=False)).get((from_min, to_min))
    benchmark = None
    if bounds is not None:
        benchmark = float(np.mean((errors_s / 60.0 >= bounds[0]) & (errors_s / 60.0 <= bounds[1])))
    return SpanScore(
        from_min=from_min,
        to_min=to_min,
        count=len(rows),
        mean_s=float(np.mean(errors_s)),
        mean_absolute_s=float(np.mean(np.abs(errors_s))),
        std_s=float(np.std(errors_s)),
        benchmark_share=benchmark,
        cal_itp_share=float(np.mean(is_cal_itp)),
        # instants are told in whole nanoseconds, arrivals seen to a second
        held_share=float(np.mean((early_s <= actual_s) & (actual_s <= late_s))),
    )
