"""`wayline evaluate outages`: takes GPS away on a schedule and scores where poses end up."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import get_args

from wayline.errors import InputError
from wayline.tuning import ArchitectureName
from wayline_evaluation.estimates import Estimates
from wayline_evaluation.growth import Drift, drift_of
from wayline_evaluation.outages import (
    OutageReport,
    OutageScore,
    outage_report,
    schedule,
    score_outage,
)
from wayline_evaluation.reference import Kind, fixes_reference
from wayline_evaluation.replay_result import Replayed
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

BETWEEN_S = 120.0
"""With GPS from one outage to the next where the user says nothing: time to calibrate again."""


@dataclass(frozen=True, slots=True)
class OutagePlan:
    """When GPS is taken away, and from which architectures."""

    lengths_s: tuple[float, ...] = (60.0,)
    every_s: float | None = None
    start_s: float = 240.0
    passes: int = 1
    architectures: tuple[ArchitectureName, ...] = ()
    """None: the one that each drive is tuned to."""
    satellites: int = 0
    """So many are left in the outages, to those who read raw measurements."""

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
            satellites=self.satellites,
        )


@dataclass(frozen=True, slots=True)
class Pass:
    """One replay with outages, and the one without."""

    folder: Path
    undisturbed: Replayed
    outages: tuple[Outage, ...]
    number: int
    architecture: ArchitectureName | None
    keep: Path | None
    yardstick: bool
    withheld: Withheld


@dataclass(frozen=True, slots=True)
class PassScores:
    """Of one replay."""

    reference: Kind
    scores: tuple[OutageScore, ...]
    drifts: tuple[Drift, ...]
    skipped: int


def architectures_of(names: str) -> tuple[ArchitectureName, ...]:
    """Names with commas between them. Raises InputError."""
    known: tuple[ArchitectureName, ...] = get_args(ArchitectureName)
    wanted = [name.strip() for name in names.split(",")]
    if unknown := [name for name in wanted if name not in known]:
        where = "--architectures"
        raise InputError(where, f"{unknown[0]!r} is not known", f"give some of {', '.join(known)}")
    return tuple(name for name in known if name in wanted)


def outage_study(
    folders: Sequence[Path], plan: OutagePlan, options: Options, progressed: Progressed
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
        [drift for each in results for drift in each.drifts],
    )


def _undisturbed(folder: Path) -> Replayed:
    return replayed(folder, (), None)


def _passes(folder: Path, run: Replayed, plan: OutagePlan, options: Options) -> Iterator[Pass]:
    for length_s in plan.lengths_s:
        schedules = plan.outages(length_s, run.end_s - run.start_s)
        for number, outages in enumerate(schedules, start=1):
            for place, architecture in enumerate(plan.architectures or (None,)):
                part = f"{length_s:g}s-{number}" + (f"-{architecture}" if architecture else "")
                keep = options.keep(folder, part)
                yardstick = options.yardstick and place == 0
                if outages:
                    yield Pass(
                        folder,
                        run,
                        tuple(outages),
                        number,
                        architecture,
                        keep,
                        yardstick,
                        options.withheld,
                    )


def _scored(one: Pass) -> PassScores:
    run = replayed(one.folder, one.outages, one.keep, one.architecture, one.withheld)
    before = one.undisturbed
    reference = truth_of(one.folder) or fixes_reference(before.fixes, before.estimates)
    filters: dict[str, Estimates] = {one.architecture or "fusion": run.estimates}
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
    drifts = tuple(
        drift_of(
            outage,
            name=name,
            drive_start_s=run.start_s,
            estimates=estimates,
            reference=reference,
        )
        for name, estimates in filters.items()
        for outage in one.outages
    )
    return PassScores(reference.kind, scores, drifts, len(found) - len(scores))
