"""`wayline evaluate accuracy`: replays drives and scores every pose."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from wayline_evaluation.accuracy import AccuracyReport, ScoredDrive, accuracy_report
from wayline_evaluation.pose_errors import compared
from wayline_evaluation.reference import fixes_reference
from wayline_evaluation.replays import (
    Options,
    Progressed,
    done_by,
    one_kind,
    replayed,
    truth_of,
)
from wayline_evaluation.told import told, told_of_all
from wayline_replay.outages import Outage
from wayline_replay.withheld import Withheld


@dataclass(frozen=True, slots=True)
class Run:
    """One drive to be scored."""

    folder: Path
    outages: tuple[Outage, ...]
    keep: Path | None
    yardstick: bool
    withheld: Withheld


def accuracy_study(
    folders: Sequence[Path], outages: Sequence[Outage], options: Options, progressed: Progressed
) -> tuple[AccuracyReport, list[ScoredDrive]]:
    """Figures, and the errors that a plot is made of. Raises InputError."""
    if options.yardstick:
        told_of_all(folders)
    runs = [
        Run(folder, tuple(outages), options.keep(folder), options.yardstick, options.withheld)
        for folder in folders
    ]
    drives = list(done_by(_scored, runs, options.jobs, progressed))
    one_kind([drive.reference for drive in drives])
    return accuracy_report(drives), drives


def _scored(run: Run) -> ScoredDrive:
    there = replayed(run.folder, run.outages, run.keep, withheld=run.withheld)
    reference = truth_of(run.folder)
    if reference is None:
        undisturbed = replayed(run.folder, (), None) if run.outages else there
        reference = fixes_reference(undisturbed.fixes, undisturbed.estimates)
    errors = {"fusion": compared(there.estimates, reference)}
    if run.yardstick:
        possible = told(run.folder, run.outages, there.estimates.times_s)
        errors["yardstick"] = compared(possible, reference)
    return ScoredDrive(there.drive, reference.kind, errors)
