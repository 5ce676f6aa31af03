"""`wayline evaluate eta`: replays simulated buses with their feed and scores what eta tells."""

import csv
import tempfile
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from wayline.errors import InputError
from wayline.messages import Arrivals, Progress, StopEvent
from wayline_evaluation.arrivals import (
    AlongTruth,
    ArrivalReport,
    ArrivalRun,
    Visited,
    arrival_run,
    pooled,
    score,
)
from wayline_evaluation.replays import Options, Progressed, done_by, drive_name, read_topic
from wayline_evaluation.trip_study import Job
from wayline_replay.replay import replay

MEND = "name drives of wayline simulate network"


def arrival_study(
    folders: Sequence[Path], feeds: Sequence[Path], options: Options, progressed: Progressed
) -> ArrivalReport:
    """Each drive and all together. Raises InputError."""
    jobs = [Job(folder, tuple(feeds), options.keep(folder)) for folder in folders]
    for job in jobs:
        read_visits(job.folder)
    runs = list(done_by(_run, jobs, options.jobs, progressed))
    return ArrivalReport(scores=tuple(map(score, runs)), pooled=pooled(runs))


def _run(job: Job) -> ArrivalRun:
    if job.keep is None:
        with tempfile.TemporaryDirectory(prefix="wayline-evaluate-") as temporary:
            return _run(Job(job.folder, job.feeds, Path(temporary)))
    replay(job.folder, job.keep, feed_paths=job.feeds)
    return arrival_run(
        drive_name(job.folder),
        read_along(job.folder),
        read_visits(job.folder),
        progress=read_topic(job.keep, Progress),
        arrivals=read_topic(job.keep, Arrivals),
        events=read_topic(job.keep, StopEvent),
    )


def read_along(folder: Path) -> AlongTruth:
    """Where a drive's truth has the vehicle along its trips. Raises InputError."""
    rows = _rows(folder / "truth.csv", ("t_s", "trip_id", "distance_m"))
    return AlongTruth(
        np.array([float(row["t_s"]) for row in rows]),
        np.array([row["trip_id"] for row in rows]),
        np.array([float(row["distance_m"] or "nan") for row in rows]),
    )


def read_visits(folder: Path) -> Visited:
    """When the vehicle came to the stops of its trips. Raises InputError."""
    rows = _rows(folder / "visits.csv", ("trip_id", "stop_id", "arrival_s"))
    return {(row["trip_id"], row["stop_id"]): float(row["arrival_s"]) for row in rows}


def _rows(path: Path, needed: Sequence[str]) -> list[dict[str, str]]:
    try:
        with path.open(newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(str(path), f"cannot be read ({error})", MEND) from None
    missing = [name for name in needed if not rows or name not in rows[0]]
    if missing:
        raise InputError(str(path), f"no column {missing[0]}", MEND)
    return rows
