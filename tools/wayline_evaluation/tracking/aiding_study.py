"""`wayline evaluate aiding`: what a receiver is told of its Dopplers, on simulated drives."""

import tempfile
from collections.abc import Sequence
from pathlib import Path

import msgspec
import numpy as np

from wayline.drive_file import load_drive
from wayline.errors import InputError
from wayline.messages import Aiding, GpsRaw
from wayline_evaluation.outages import schedule
from wayline_evaluation.replays import (
    Progressed,
    done_by,
    drive_name,
    needed_truth,
    read_topic,
)
from wayline_evaluation.tracking.predicted import Errors, Predicted, errors_of, predicted
from wayline_replay.outages import Outage
from wayline_replay.replay import replay
from wayline_replay.stream import DriveStream

LEARNED_S = 60.0
"""From a drive's start on sensors are being learned: no figures are of it."""


class AidingPlan(msgspec.Struct, frozen=True, kw_only=True):
    """When GPS is taken away, and what of an outage counts."""

    length_s: float = 60.0
    every_s: float = 180.0
    start_s: float = 240.0


class DriveAiding(msgspec.Struct, frozen=True, kw_only=True):
    """Of one drive, or of all."""

    drive: str
    with_gps: Predicted | None
    in_outages: Predicted | None


class AidingReport(msgspec.Struct, frozen=True, kw_only=True):
    """What was found."""

    drives: tuple[DriveAiding, ...]
    length_s: float
    every_s: float


def aiding_study(
    folders: Sequence[Path], plan: AidingPlan, jobs: int, progressed: Progressed
) -> AidingReport:
    """Every drive replayed with outages. Raises InputError without raw measurements or truth."""
    if plan.every_s <= plan.length_s:
        what = f"{plan.every_s:g} s leave no GPS between outages"
        raise InputError("--every", what, "give more than the length")
    work = [(folder, plan) for folder in folders]
    drives = tuple(done_by(_studied, work, jobs, progressed))
    return AidingReport(drives=drives, length_s=plan.length_s, every_s=plan.every_s)


def _studied(work: tuple[Path, AidingPlan]) -> DriveAiding:
    folder, plan = work
    truth = needed_truth(folder)
    drive = load_drive(folder)
    messages = (each.message for each in DriveStream(drive, str(folder)))
    epochs = [message for message in messages if isinstance(message, GpsRaw)]
    if not epochs:
        mend = "add a [[raw]] table to its drive.toml, or simulate with --raw"
        raise InputError(str(folder), "has no raw measurements", mend)
    start_s, end_s = float(truth.times_s[0]), float(truth.times_s[-1])
    (outages,) = schedule(
        length_s=plan.length_s,
        every_s=plan.every_s,
        start_s=plan.start_s,
        passes=1,
        until_s=end_s - start_s,
    )
    with tempfile.TemporaryDirectory(prefix="wayline-evaluate-") as temporary:
        replay(folder, Path(temporary), outages=outages)
        errors = errors_of(read_topic(Path(temporary), Aiding), epochs, truth)
    blind = _in_outages(errors, start_s, outages)
    learned = errors.times_s >= start_s + LEARNED_S
    return DriveAiding(
        drive=drive_name(folder),
        with_gps=predicted(errors, learned & ~blind),
        in_outages=predicted(errors, learned & blind),
    )


def _in_outages(errors: Errors, start_s: float, outages: Sequence[Outage]) -> np.ndarray:
    since_s = errors.times_s - start_s
    blind = np.zeros(len(since_s), dtype=np.bool_)
    for outage in outages:
        blind |= (since_s >= outage.start_s) & (since_s < outage.start_s + outage.length_s)
    return blind
