"""`wayline evaluate trips`: replays drives with a feed and scores the trips that were found."""

import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from wayline.messages import GpsFix, Progress
from wayline.timetable.reading import read_timetable
from wayline_evaluation.replays import Options, Progressed, done_by, drive_name, read_topic
from wayline_evaluation.trip_truth import read_trip_truth
from wayline_evaluation.trips import TripReport, TripRun, pooled, trip_run
from wayline_replay.replay import replay


@dataclass(frozen=True, slots=True)
class Job:
    """One drive with the feeds of its trips."""

    folder: Path
    feeds: tuple[Path, ...]
    keep: Path | None


def trip_study(
    folders: Sequence[Path], feeds: Sequence[Path], options: Options, progressed: Progressed
) -> TripReport:
    """Each drive and all together. Raises InputError."""
    jobs = [Job(folder, tuple(feeds), options.keep(folder)) for folder in folders]
    for job in jobs:
        read_trip_truth(job.folder)
    runs = list(done_by(_scored, jobs, options.jobs, progressed))
    return TripReport(scores=tuple(run.score for run in runs), pooled=pooled(runs))


def _scored(job: Job) -> TripRun:
    if job.keep is None:
        with tempfile.TemporaryDirectory(prefix="wayline-evaluate-") as temporary:
            return _scored(Job(job.folder, job.feeds, Path(temporary)))
    replay(job.folder, job.keep, feed_paths=job.feeds)
    return trip_run(
        drive_name(job.folder),
        read_trip_truth(job.folder),
        read_topic(job.keep, Progress),
        read_topic(job.keep, GpsFix),
        [read_timetable(feed) for feed in job.feeds],
    )
