"""Runs drives through the system for a study, several at a time, and reads what came out."""

import multiprocessing
import tempfile
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

import msgspec

from wayline.drive_file import load_drive
from wayline.errors import InputError
from wayline.messages import (
    Barometer,
    FusionStatus,
    GpsFix,
    Gyro,
    Message,
    Odometer,
    Pose,
    Torque,
)
from wayline.tuning import ArchitectureName
from wayline_evaluation.estimates import estimates_of
from wayline_evaluation.reference import Kind, Reference
from wayline_evaluation.replay_result import Replayed
from wayline_evaluation.truth import read_truth
from wayline_replay.outages import Outage
from wayline_replay.replay import replay
from wayline_replay.withheld import NOTHING, Withheld

Progressed = Callable[[int, int], None]
"""Called with how many replays of how many are done."""
INGESTED: tuple[type[Message], ...] = (GpsFix, Odometer, Gyro, Torque, Barometer)
HEAD_ROWS = 1_000
"""The smallest time of a topic is among its first rows."""
MessageType = TypeVar("MessageType", bound=Message)
Job = TypeVar("Job")
Result = TypeVar("Result")


@dataclass(frozen=True, slots=True)
class Options:
    """What all studies can be asked for."""

    out: Path | None = None
    """Keep the replays there, in a folder each."""
    jobs: int = 1
    """Processes at a time."""
    yardstick: bool = False
    withheld: Withheld = NOTHING

    def keep(self, folder: Path, part: str = "") -> Path | None:
        """Where a replay of a drive is kept."""
        return None if self.out is None else self.out / drive_name(folder) / part


def replayed(
    folder: Path,
    outages: Sequence[Outage],
    keep: Path | None,
    architecture: ArchitectureName | None = None,
    withheld: Withheld = NOTHING,
) -> Replayed:
    """Replay a drive into `keep`, or into a folder that is gone afterwards. Raises InputError."""
    if keep is None:
        with tempfile.TemporaryDirectory(prefix="wayline-evaluate-") as temporary:
            return replayed(folder, outages, Path(temporary), architecture, withheld)
    replay(folder, keep, outages=outages, architecture=architecture, withheld=withheld)
    return read_replay(folder, keep)


def read_replay(folder: Path, out: Path) -> Replayed:
    """Read what `wayline replay` wrote of a drive."""
    poses = read_topic(out, Pose)
    if not poses:
        raise InputError(str(folder), "its replay has no pose", "name a drive with GPS or CAN")
    return Replayed(
        drive=drive_name(folder),
        start_s=start_of(out),
        end_s=poses[-1].t_ns * 1e-9,
        estimates=estimates_of(poses),
        fixes=tuple(read_topic(out, GpsFix)),
        verdicts=tuple(
            each for status in read_topic(out, FusionStatus) for each in status.verdicts
        ),
        lost_share=sum(pose.mode == "lost" for pose in poses) / len(poses),
    )


def read_topic(out: Path, kind: type[MessageType], rows: int | None = None) -> list[MessageType]:
    """The messages of one topic of a replay, or its first rows."""
    decoder = msgspec.json.Decoder(kind)
    with (out / f"{kind.topic}.jsonl").open("rb") as file:
        lines = file if rows is None else (line for _, line in zip(range(rows), file, strict=False))
        return [decoder.decode(line) for line in lines]


def start_of(out: Path) -> float:
    """Smallest time of what a replay was given, in Unix seconds."""
    heads = [read_topic(out, kind, HEAD_ROWS) for kind in INGESTED]
    return min(message.t_ns for head in heads for message in head) * 1e-9


def truth_of(folder: Path) -> Reference | None:
    """The drive's truth; None where it has none."""
    drive = load_drive(folder)
    return None if drive.truth is None else read_truth(Path(drive.truth.path))


def needed_truth(folder: Path) -> Reference:
    """The drive's truth. Raises InputError where it has none."""
    truth = truth_of(folder)
    if truth is None:
        mend = "add a [truth] table to its drive.toml, or simulate a drive"
        raise InputError(str(folder), "has no truth", mend)
    return truth


def drive_name(folder: Path) -> str:
    """What a drive is called in tables."""
    return (folder.parent if folder.suffix == ".toml" else folder).resolve().name


def one_kind(references: Sequence[Kind]) -> Kind:
    """The kind of reference that all drives have: pooled figures mean one thing."""
    if len(set(references)) > 1:
        mend = "evaluate drives with a truth apart from those without"
        raise InputError("drives", "some have a truth and some have none", mend)
    return references[0]


def done_by(
    work: Callable[[Job], Result], jobs: Sequence[Job], processes: int, progressed: Progressed
) -> Iterator[Result]:
    """Results in the order of the jobs, worked on by so many processes."""
    progressed(0, len(jobs))
    if processes <= 1 or len(jobs) == 1:
        for number, job in enumerate(jobs, start=1):
            yield work(job)
            progressed(number, len(jobs))
        return
    # a forked process would inherit the threads of the progress bar
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(min(processes, len(jobs)), mp_context=context) as pool:
        for number, result in enumerate(pool.map(work, jobs), start=1):
            yield result
            progressed(number, len(jobs))
