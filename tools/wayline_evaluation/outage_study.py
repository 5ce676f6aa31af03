"""`wayline evaluate outages`: takes GPS away on a schedule and scores where poses end up."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from wayline.errors import InputError
from wayline_cli.stream import Outage
from wayline_evaluation.outages import (
    OutageReport,
    OutageScore,
    outage_report,
    schedule,
    score_outage,
)
from wayline_evaluation.reference import Kind, fixes_reference
from wayline_evaluation.replays import (
    Options,
    Progressed,
    Replayed,
    done_by,
    one_kind,
    replayed,
    truth_of,
)
from wayline_evaluation.told import told, told_of_all

BETWEEN_S = 120.0
"""With GPS from one outage to the next where the user says nothing: time to calibrate again."""


@dataclass(frozen=True, slots=True)
class Plan:
    """When GPS is taken away."""

    lengths_s: tuple[float, ...] = (60.0,)
    every_s: float | None = None
    start_s: float = 240.0
    passes: int = 1

    def outages(self, length_s: float, until_s: float) -> list[list[Outage]]:
        """Outages of every pass over a drive. Raises InputError."""
        every_s = self.every_s or length_s + BETWEEN_S
        if every_s <= length_s:
            raise InputError("--every", f"{every_s:g} s leave no GPS between outages", "give more")
        return schedule(
            length_s=length_s,
            every_s=every_s,
            start_s=self.start_s,
            passes=self.passes,
            until_s=until_s,
        )


@dataclass(frozen=True, slots=True)
class Pass:
    """One replay with outages, and the one without."""

    folder: Path
    undisturbed: Replayed
    outages: tuple[Outage, ...]
    number: int
    keep: Path | None
    yardstick: bool


@dataclass(frozen=True, slots=True)
class PassScores:
    """Of one replay."""

    reference: Kind
    scores: tuple[OutageScore, ...]
    skipped: int


def outage_study(
    folders: Sequence[Path], plan: Plan, options: Options, progressed: Progressed
) -> OutageReport:
    """Errors at the end of outages. Raises InputError."""
    if options.yardstick:
        told_of_all(folders)
    undisturbed = list(done_by(_undisturbed, folders, options.jobs, progressed))
    passes = [
        one
        for folder, run in zip(folders, undisturbed, strict=True)
        for one in _passes(folder, run, plan, options)
    ]
    if not passes:
        raise InputError(str(folders[0]), "ends before its first outage does", "lower --start")
    results = list(done_by(_scored, passes, options.jobs, progressed))
    return outage_report(
        one_kind([each.reference for each in results]),
        [score for each in results for score in each.scores],
        sum(each.skipped for each in results),
    )


def _undisturbed(folder: Path) -> Replayed:
    return replayed(folder, (), None)


def _passes(folder: Path, run: Replayed, plan: Plan, options: Options) -> Iterator[Pass]:
    for length_s in plan.lengths_s:
        schedules = plan.outages(length_s, run.end_s - run.start_s)
        for number, outages in enumerate(schedules, start=1):
            keep = options.keep(folder, f"{length_s:g}s-{number}")
            if outages:
                yield Pass(folder, run, tuple(outages), number, keep, options.yardstick)


def _scored(one: Pass) -> PassScores:
    run, before = replayed(one.folder, one.outages, one.keep), one.undisturbed
    reference = truth_of(one.folder) or fixes_reference(before.fixes, before.estimates)
    filters = {"fusion": run.estimates}
    if one.yardstick:
        filters["yardstick"] = told(one.folder, one.outages, run.estimates.times_s)
    found = [
        score_outage(
            outage,
            drive=run.drive,
            name=name,
            pass_number=one.number,
            drive_start_s=run.start_s,
            estimates=estimates,
            reference=reference,
        )
        for name, estimates in filters.items()
        for outage in one.outages
    ]
    scores = tuple(score for score in found if score is not None)
    return PassScores(reference.kind, scores, len(found) - len(scores))
