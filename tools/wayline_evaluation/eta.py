"""Pure: what was told of a drive's arrivals beside when the vehicle came, as eta scores it."""

from collections import defaultdict
from collections.abc import Iterable, Sequence
from typing import NamedTuple

import msgspec
import numpy as np
from numpy.typing import NDArray

from wayline.messages import Arrivals, StopEvent
from wayline_eta.scores import Prediction, Score, Sums, added, score_of, sums_of
from wayline_evaluation.eta_trials import CAME, StopErrors, Trial, TrialErrors, by_stop

GHOST_S = 600.0
"""An arrival that was due so long before the end, and has not come by then, never does."""

ARRIVING_S = 15.0
"""Who stands in the truth and who is seen to stand may be so far apart."""

StopKey = tuple[str | None, str]
"""Trip (None on a route without, and where it is not certain) and stop."""


EVERY_NS = 60_000_000_000
"""What is compared with what others tell is taken so often."""


class Beside(NamedTuple):
    """Predictions of eta and of a yardstick, of the same arrivals at the same instants."""

    told: list[Arrivals]
    yardstick: list[Arrivals]


class EtaScore(Score, frozen=True, kw_only=True):
    """One drive, or all together."""

    drive: str


class LapScore(msgspec.Struct, frozen=True, kw_only=True):
    """What was told during one lap or trip, of any stop."""

    trial: str
    count: int
    mean_absolute_s: float
    held_share: float


class YardstickScore(msgspec.Struct, frozen=True, kw_only=True):
    """What was told beside what a yardstick tells of the same arrivals, once a minute."""

    told: EtaScore
    yardstick: EtaScore


class EtaReport(msgspec.Struct, frozen=True, kw_only=True):
    """What `wayline evaluate eta --json` writes."""

    scores: tuple[EtaScore, ...]
    pooled: EtaScore
    trials: tuple[TrialErrors, ...]
    """Tables 2 and 4 of papers/000."""
    stops: tuple[StopErrors, ...]
    """Its table 3."""
    laps: tuple[LapScore, ...]
    """In their order: whether predictions grow better."""
    yardstick: YardstickScore | None = None
    """Of all drives together; null where it was not asked for."""
    timetable: YardstickScore | None = None
    """What the timetable says in the place of one; null where there is none."""


class EtaRun(NamedTuple):
    """What is scored of one drive."""

    drive: str
    predictions: Sequence[Prediction]
    arrivals: int
    told_seconds: int
    seconds: int
    trials: Sequence[TrialErrors] = ()
    laps: Sequence[LapScore] = ()
    beside: tuple[Sequence[Prediction], Sequence[Prediction]] | None = None
    """What was told, and what a yardstick tells."""
    planned: tuple[Sequence[Prediction], Sequence[Prediction]] | None = None
    """What was told, and what the timetable says."""


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
        for key in dict.fromkeys(((event.trip_id, event.stop_id), (None, event.stop_id))):
            if event.kind in CAME:
                came[key].append(event.t_ns)
            elif event.kind == "departed":
                left[key].append(event.t_ns)
    return {key: np.sort(np.array(times, np.int64)) for key, times in {**left, **came}.items()}


def scored(run: EtaRun) -> EtaScore:
    """Figures of one drive."""
    return _named(run.drive, _sums(run))


def pooled(runs: Sequence[EtaRun]) -> EtaScore:
    """Figures of all drives together."""
    return _named("all", added(map(_sums, runs)))


def report_of(runs: Sequence[EtaRun]) -> EtaReport:
    """What all drives say."""
    trials = [trial for run in runs for trial in run.trials]
    return EtaReport(
        scores=tuple(map(scored, runs)),
        pooled=pooled(runs),
        trials=tuple(trials),
        stops=tuple(by_stop(trials)),
        laps=tuple(lap for run in runs for lap in run.laps),
        yardstick=_beside([run.beside for run in runs if run.beside is not None]),
        timetable=_beside([run.planned for run in runs if run.planned is not None]),
    )


def _beside(
    pairs: Sequence[tuple[Sequence[Prediction], Sequence[Prediction]]],
) -> YardstickScore | None:
    if not pairs:
        return None
    told, yardstick = (added(map(sums_of, each)) for each in zip(*pairs, strict=True))
    return YardstickScore(told=_named("told", told), yardstick=_named("yardstick", yardstick))


def lap_score(trial: Trial, told: Sequence[Arrivals], events: Sequence[StopEvent]) -> LapScore:
    """How good was what was told from a trial's first stop to its end."""
    begin_ns, end_ns = trial.before[0].t_ns, trial.end.t_ns
    predictions = predictions_of([one for one in told if begin_ns <= one.t_ns < end_ns], events)
    spans = sums_of(predictions).spans
    count = sum(span.count for span in spans)
    return LapScore(
        trial=trial.name,
        count=count,
        mean_absolute_s=sum(span.absolute_s for span in spans) / max(count, 1),
        held_share=sum(span.held for span in spans) / max(count, 1),
    )


def _sums(run: EtaRun) -> Sums:
    of_drive = Sums(arrivals=run.arrivals, told_s=run.told_seconds, on_route_s=run.seconds)
    return sums_of(run.predictions).plus(of_drive)


def _named(drive: str, sums: Sums) -> EtaScore:
    return EtaScore(drive=drive, **msgspec.structs.asdict(score_of(sums)))
