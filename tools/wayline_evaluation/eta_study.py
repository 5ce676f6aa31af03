"""`wayline evaluate eta`: replays drives and scores the arrivals that were told."""

import tempfile
from collections import deque
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from wayline.drive_file import load_drive
from wayline.errors import InputError
from wayline.messages import Arrivals, GpsFix, Pose, Progress, StopEvent
from wayline.node import Node
from wayline.replayed_drive import ReplayedDrive
from wayline.route import Route
from wayline.route_file import load_route
from wayline.timetable.reading import read_timetable
from wayline_eta.replayed import node
from wayline_eta.scores import Prediction
from wayline_evaluation.eta import Beside, EtaReport, EtaRun, lap_score, predictions_of, report_of
from wayline_evaluation.eta_timetable import promised
from wayline_evaluation.eta_trials import CAME, errors_of, trials_from, trials_of
from wayline_evaluation.eta_yardstick import (
    Ask,
    asked,
    expect_yardstick,
    no_yardstick,
    other_laps,
    told_streets,
)
from wayline_evaluation.reference import Reference
from wayline_evaluation.replays import (
    MessageType,
    Options,
    Progressed,
    done_by,
    drive_name,
    read_topic,
    truth_of,
)
from wayline_evaluation.trip_truth import read_trip_truth
from wayline_replay.replay import replay

SECOND_NS = 1_000_000_000
TRUTH_STD_M = 1.0


@dataclass(frozen=True, slots=True)
class Followed:
    """What vehicles follow besides their drives' own routes, and where lessons are kept."""

    routes: tuple[Path, ...] = ()
    feeds: tuple[Path, ...] = ()
    database_url: str | None = None
    from_lap: int = 1
    """What was told in earlier laps or trips of a drive is not scored."""


@dataclass(frozen=True, slots=True)
class Job:
    """One drive."""

    folder: Path
    followed: Followed
    keep: Path | None
    yardstick: bool = False


def eta_study(
    folders: Sequence[Path], followed: Followed, options: Options, progressed: Progressed
) -> tuple[EtaReport, list[EtaRun]]:
    """Each drive in its order and all together, and what that rests on. Raises InputError.

    With a database each drive builds on what those before have taught; then one is replayed at a
    time.
    """
    jobs = [Job(each, followed, options.keep(each), options.yardstick) for each in folders]
    for job in jobs:
        if job.yardstick:
            expect_yardstick(job.folder, truth_of(job.folder), _routes(job.folder, followed))
    at_a_time = options.jobs if followed.database_url is None else 1
    runs = list(done_by(_run, jobs, at_a_time, progressed))
    return report_of(runs), runs


def _run(job: Job) -> EtaRun:
    if job.keep is None:
        with tempfile.TemporaryDirectory(prefix="wayline-evaluate-") as temporary:
            return _run(replace(job, keep=Path(temporary)))
    followed = job.followed
    replay(
        job.folder,
        job.keep,
        database_url=followed.database_url,
        route_paths=followed.routes,
        feed_paths=followed.feeds,
    )
    return _scored(job, job.keep)


def _scored(job: Job, out: Path) -> EtaRun:
    name, from_lap = drive_name(job.folder), job.followed.from_lap
    events, way = _true_way(job, out)
    trials = trials_from(from_lap, trials_of(name, events), name)
    from_ns = trials[0].before[0].t_ns if from_lap > 1 else 0
    told = _since(from_ns, read_topic(out, Arrivals))
    came = _since(from_ns, events)
    progress = _since(from_ns, read_topic(out, Progress))
    on_route = {each.t_ns for each in progress if each.on_route}
    beside, planned = None, promised(told)
    if job.yardstick:
        beside = asked(told, _yardstick(job, way, events))
    return EtaRun(
        name,
        predictions_of(told, came),
        sum(event.kind in CAME for event in came),
        sum(each.t_ns in on_route and bool(each.stops) and not each.stale for each in told),
        len(on_route),
        trials=[errors for trial in trials if (errors := errors_of(trial, told)) is not None],
        laps=[lap_score(trial, told, came) for trial in trials],
        beside=_predictions_of(beside, came),
        planned=_predictions_of(planned, came),
    )


def _predictions_of(
    pair: Beside | None, came: Sequence[StopEvent]
) -> tuple[list[Prediction], list[Prediction]] | None:
    if pair is None:
        return None
    return predictions_of(pair.told, came), predictions_of(pair.yardstick, came)


def _since(from_ns: int, messages: Iterable[MessageType]) -> list[MessageType]:
    return [each for each in messages if each.t_ns >= from_ns]


def _yardstick(job: Job, way: Sequence[Progress], events: Sequence[StopEvent]) -> Ask:
    """Who knows more of a drive. Raises InputError where nobody does."""
    ask = told_streets(job.folder) or other_laps(way, events)
    if ask is None:
        raise no_yardstick(job.folder)
    return ask


def _true_way(job: Job, out: Path) -> tuple[list[StopEvent], list[Progress]]:
    """What the vehicle did at stops, and where it was on its route, as far as there is a truth.

    Without one it came to stops when eta says so.
    """
    truth = truth_of(job.folder)
    if truth is None:
        return read_topic(out, StopEvent), []
    seen = list(_seen(_eta(job.folder, job.followed), truth, _assigned(job)))
    events = [each for each in seen if isinstance(each, StopEvent)]
    return events, [each for each in seen if isinstance(each, Progress)]


def _eta(folder: Path, followed: Followed) -> Node:
    """For a receiver that errs by nothing."""
    return node(
        ReplayedDrive(
            drive=load_drive(folder),
            routes=_routes(folder, followed),
            timetables=tuple(read_timetable(path) for path in followed.feeds),
            database_url=None,
        )
    )


def _routes(folder: Path, followed: Followed) -> tuple[Route, ...]:
    route = load_drive(folder).route
    own = map(Path, route.paths) if route else ()
    return tuple(load_route(path) for path in followed.routes or own)


def _assigned(job: Job) -> list[GpsFix]:
    """What the vehicle ran, by the truth where that tells it, else by its reports."""
    try:
        truth = read_trip_truth(job.folder)
    except InputError:
        return [fix for fix in read_topic(job.keep or job.folder, GpsFix) if fix.assignment]
    begins = np.flatnonzero(truth.trips[1:] != truth.trips[:-1]) + 1
    return [
        GpsFix(t_ns=round(float(truth.times_s[at]) * 1e9), valid=False, assignment=trip)
        for at in (0, *begins.tolist())
        if (trip := str(truth.trips[at]))
    ]


def _seen(
    eta: Node, truth: Reference, assigned: Sequence[GpsFix]
) -> Iterator[StopEvent | Progress]:
    """What eta says of a vehicle by its true way."""
    waiting = deque(assigned)
    for pose in _poses(truth):
        while waiting and waiting[0].t_ns <= pose.t_ns:
            told = GpsFix(t_ns=pose.t_ns, valid=False, assignment=waiting.popleft().assignment)
            yield from _said(eta, told, "gps-ingest")
        yield from _said(eta, pose, "fusion")


def _said(eta: Node, message: Pose | GpsFix, source: str) -> Iterator[StopEvent | Progress]:
    told = eta.take(message, source)
    return (each for each in told if isinstance(each, StopEvent | Progress))


def _poses(truth: Reference) -> Iterator[Pose]:
    """One a second."""
    seconds = np.arange(np.ceil(truth.times_s[0]), truth.times_s[-1])
    there = truth.at(seconds)
    distance_m = 0.0
    for second, lat_deg, lon_deg, speed_mps in zip(
        seconds, there.lats_deg, there.lons_deg, there.speeds_mps, strict=True
    ):
        distance_m += abs(float(speed_mps))
        yield Pose(
            t_ns=round(float(second)) * SECOND_NS,
            mode="fused",
            lat_deg=float(lat_deg),
            lon_deg=float(lon_deg),
            speed_mps=float(speed_mps),
            distance_m=distance_m,
            east_std_m=TRUTH_STD_M,
            north_std_m=TRUTH_STD_M,
        )
