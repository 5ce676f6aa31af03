"""`wayline evaluate slope`: grade of several runs of one road, each sensor alone and together."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from wayline.drive_file import load_drive
from wayline_evaluation.estimates import Estimates
from wayline_evaluation.replays import (
    Options,
    Progressed,
    done_by,
    drive_name,
    needed_truth,
    replayed,
)
from wayline_evaluation.sensed import Sensed
from wayline_evaluation.sensed_drive import sense
from wayline_evaluation.slope import Grades, Profiles, SlopeReport, profiles_of, slope_report
from wayline_evaluation.thesis_filter import (
    SENSORS,
    SHIFTS_S,
    mean_speeds_mps,
    measured,
    seconds_of,
    thesis_slopes_pct,
)
from wayline_evaluation.told import told, told_of_all


@dataclass(frozen=True, slots=True)
class Run:
    """One drive along the road."""

    folder: Path
    keep: Path | None
    yardstick: bool


def slope_study(
    folders: Sequence[Path], options: Options, progressed: Progressed
) -> tuple[SlopeReport, Profiles]:
    """Figures, and the profiles that a plot is made of. Raises InputError."""
    if options.yardstick:
        told_of_all(folders)
    truths = [needed_truth(folder) for folder in folders]
    runs = [Run(folder, options.keep(folder), options.yardstick) for folder in folders]
    grades = list(done_by(_grades, runs, options.jobs, progressed))
    shifts_s = {way: each.shift_s for way, each in grades[0].items()}
    profiles = profiles_of(truths, grades)
    return slope_report([drive_name(folder) for folder in folders], profiles, shifts_s), profiles


def thesis_grades(sensed: Sensed) -> dict[str, Grades]:
    """What each sensor of papers/004 that the drive has says alone."""
    times_s = seconds_of(sensed)
    measurements, speeds_mps = measured(sensed, times_s), mean_speeds_mps(sensed, times_s)
    return {
        sensor: Grades(
            times_s, thesis_slopes_pct(measurements, speeds_mps, sensor), SHIFTS_S[sensor]
        )
        for sensor in SENSORS
        if not np.isnan(measurements[sensor]).all()
    }


def _grades(run: Run) -> dict[str, Grades]:
    estimates = replayed(run.folder, (), run.keep).estimates
    ways = thesis_grades(sense(load_drive(run.folder), run.folder))
    ways["fusion"] = _unshifted(estimates)
    if run.yardstick:
        ways["yardstick"] = _unshifted(told(run.folder, (), estimates.times_s))
    return ways


def _unshifted(estimates: Estimates) -> Grades:
    return Grades(estimates.times_s, estimates.grades_pct, 0.0)
