"""`wayline evaluate smoothing`: smooths trips in every way and sets them beside their reference."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np

from wayline.errors import InputError
from wayline_evaluation.replays import Progressed, done_by, drive_name
from wayline_evaluation.smoothing.fused import by_fusion
from wayline_evaluation.smoothing.reading import read_trip
from wayline_evaluation.smoothing.report import SmoothingReport, report_of
from wayline_evaluation.smoothing.scores import TripScore, score_of
from wayline_evaluation.smoothing.smoothers import SMOOTHERS, Made, Method
from wayline_evaluation.smoothing.trip import Trip


@dataclass(frozen=True, slots=True)
class Job:
    """One trip to be scored."""

    folder: Path
    with_fusion: bool


class Scored(NamedTuple):
    """What came of it."""

    name: str
    score: TripScore | None
    notes: tuple[str, ...]


def shown_trip(
    folders: Sequence[Path], report: SmoothingReport
) -> tuple[Trip, Mapping[Method, Made]]:
    """The trip with the most bad fixes, smoothed once more: what a plot shows of one trip."""
    most = max(report.trips, key=lambda each: each.bad_fixes)
    folder = next(folder for folder in folders if drive_name(folder) == most.trip)
    trip = read_trip(folder).trip
    if trip is None:
        raise InputError(str(folder), "has changed since it was read", "try again")
    return trip, smoothed(folder, trip, with_fusion=False)


def smoothing_study(
    folders: Sequence[Path], fused: int, jobs: int, progressed: Progressed
) -> SmoothingReport:
    """Every trip by itself and all together; fusion, slow as it is, on so many of them.

    Raises InputError where nothing of a drive can be read, or no trip is left.
    """
    chosen = set(np.linspace(0, len(folders) - 1, min(fused, len(folders))).round().astype(int))
    work = [Job(folder, number in chosen) for number, folder in enumerate(folders)]
    scores: list[TripScore] = []
    notes: dict[str, tuple[str, ...]] = {}
    for scored in done_by(scored_trip, work, jobs, progressed):
        if scored.notes:
            notes[scored.name] = scored.notes
        if scored.score is not None:
            scores.append(scored.score)
    if not scores:
        name, told = next(iter(notes.items()))
        why, _, mend = told[-1].removeprefix("left out: ").partition("; ")
        raise InputError(name, why, mend or "name longer trips")
    return report_of(scores, notes)


def scored_trip(job: Job) -> Scored:
    """Read, smooth, score."""
    name, trip, notes = read_trip(job.folder)
    if trip is None:
        return Scored(name, None, notes)
    return Scored(
        name, score_of(trip, smoothed(job.folder, trip, with_fusion=job.with_fusion)), notes
    )


def smoothed(folder: Path, trip: Trip, *, with_fusion: bool) -> Mapping[Method, Made]:
    """The trip by all methods."""
    made: dict[Method, Made] = {name: smoother(trip) for name, smoother in SMOOTHERS.items()}
    if with_fusion:
        made["fusion"] = by_fusion(folder, trip)
    return made
