"""`wayline evaluate sparse`: lets receivers tell fixes seldom, and scores how that is borne."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import msgspec

from wayline_evaluation.reference import fixes_reference
from wayline_evaluation.replays import Options, Progressed, done_by, replayed, truth_of
from wayline_evaluation.sparse import SparseReport, SparseRun, sparse_run
from wayline_replay.withheld import Withheld


@dataclass(frozen=True, slots=True)
class Run:
    """One drive with one interval."""

    folder: Path
    withheld: Withheld
    keep: Path | None


def sparse_study(
    folders: Sequence[Path], intervals_s: Sequence[float], options: Options, progressed: Progressed
) -> tuple[SparseReport, list[SparseRun]]:
    """Each drive with each interval: figures, and what a plot is made of. Raises InputError."""
    runs = [
        Run(
            folder,
            msgspec.structs.replace(options.withheld, fixes_every_s=every_s),
            options.keep(folder, f"every-{every_s:g}s"),
        )
        for folder in folders
        for every_s in intervals_s
    ]
    scored = list(done_by(_scored, runs, options.jobs, progressed))
    return SparseReport(scores=tuple(each.score for each in scored)), scored


def _scored(run: Run) -> SparseRun:
    there = replayed(run.folder, (), run.keep, withheld=run.withheld)
    reference = truth_of(run.folder)
    if reference is None:
        whole = replayed(run.folder, (), None)
        reference = fixes_reference(whole.fixes, whole.estimates)
    return sparse_run(there, reference, run.withheld.fixes_every_s)
