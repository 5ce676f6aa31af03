"""`wayline evaluate slope`: grade of several runs of one road, each sensor alone and together."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple, get_args

import numpy as np

from wayline.drive import Drive
from wayline.drive_file import load_drive
from wayline.tuning import VerticalSensor
from wayline_evaluation.estimates import Estimates, Floats
from wayline_evaluation.figures import figures_of
from wayline_evaluation.reference import Reference
from wayline_evaluation.replays import Options, Progressed, done_by, drive_name, truth_of
from wayline_evaluation.sensed import Sensed, sensed_of
from wayline_evaluation.slope import (
    SPACING_M,
    Grades,
    MassFound,
    Profiles,
    Resolution,
    SlopeReport,
    profiles_at,
    profiles_of,
    slope_report,
)
from wayline_evaluation.slope_drive import (
    Driven,
    driven,
    driven_by,
    map_grades,
    read_every_metre,
    told_by,
)
from wayline_evaluation.slope_places import passed_s, points_along
from wayline_evaluation.slope_reference import RoadReference
from wayline_evaluation.thesis_filter import (
    SENSORS,
    SHIFTS_S,
    mean_speeds_mps,
    measured,
    seconds_of,
    thesis_slopes_pct,
)
from wayline_evaluation.told import told, told_of_all
from wayline_simulator.facts_file import read_facts

ALONE: tuple[VerticalSensor, ...] = get_args(VerticalSensor)
RESOLUTIONS_M = (1.0, 20.0, 100.0)
"""Those of papers/004, section 5.5."""


@dataclass(frozen=True, slots=True)
class Run:
    """One drive along the road."""

    folder: Path
    keep: Path | None
    yardstick: bool
    resolutions_m: tuple[float, ...]


class Driving(NamedTuple):
    """What is known of a run besides the truth."""

    grades: dict[str, Grades]
    estimates: Estimates
    by_bin_m: dict[float, tuple[Floats, Floats]]
    """The map read at every metre of the way: instants and grades, by the length of its bins."""
    mass: MassFound
    mass_kg: tuple[Floats, Floats]
    """Over time: distance travelled in m, and what the vehicle was taken to weigh."""


def slope_study(
    folders: Sequence[Path],
    options: Options,
    progressed: Progressed,
    *,
    reference: RoadReference | None = None,
    resolutions_m: tuple[float, ...] = RESOLUTIONS_M,
) -> tuple[SlopeReport, Profiles, list[Driving]]:
    """Figures, and what plots are made of. Raises InputError."""
    if options.yardstick:
        told_of_all(folders)
    truths = [truth_of(folder) for folder in folders]
    runs = [
        Run(folder, options.keep(folder), options.yardstick, resolutions_m) for folder in folders
    ]
    drivings = list(done_by(_driving, runs, options.jobs, progressed))
    profiles = _profiles(truths, drivings, reference)
    shifts_s = {way: each.shift_s for way, each in drivings[0].grades.items()}
    report = slope_report(
        [drive_name(folder) for folder in folders],
        profiles,
        shifts_s,
        _resolutions(truths, drivings, resolutions_m),
        [driving.mass for driving in drivings],
    )
    return report, profiles, drivings


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


def _profiles(
    truths: Sequence[Reference | None],
    drivings: Sequence[Driving],
    reference: RoadReference | None,
) -> Profiles:
    """Against the reference where one is given, else the truths if every run has one."""
    grades = [driving.grades for driving in drivings]
    known = [truth for truth in truths if truth is not None and np.isfinite(truth.grades_pct).any()]
    if reference is None and len(known) == len(drivings):
        return profiles_of(known, grades)
    distances_m, points = points_along(drivings[0].estimates, SPACING_M)
    passed = [passed_s(driving.estimates, points) for driving in drivings]
    if reference is not None:
        return profiles_at(distances_m, passed, grades, reference.at(points), "reference")
    unknown = np.full(len(distances_m), np.nan)
    return profiles_at(distances_m, passed, grades, unknown, "each other")


def _driving(run: Run) -> Driving:
    drive = load_drive(run.folder)
    said = told_by(drive, run.folder)
    found = driven(drive, said, run.keep)
    ways = thesis_grades(sensed_of(message for message, _ in said))
    ways["fusion"] = _live(found.estimates)
    by_map = map_grades(found, drive, SPACING_M)
    for sensor in ALONE:
        if sensor in by_map:
            ways[f"live_{sensor}"] = _live(driven_by(drive, said, sensor))
    for name, grades in by_map.items():
        ways["map" if name == "fused" else f"map_{name}"] = grades
    if run.yardstick:
        ways["yardstick"] = _live(told(run.folder, (), found.estimates.times_s))
    return Driving(
        ways,
        found.estimates,
        {bin_m: read_every_metre(found, drive, bin_m) for bin_m in run.resolutions_m},
        _mass(found, drive, run.folder),
        _masses_kg(found),
    )


def _live(estimates: Estimates) -> Grades:
    return Grades(estimates.times_s, estimates.grades_pct, stds_pct=estimates.grade_stds_pct)


def _mass(found: Driven, drive: Drive, folder: Path) -> MassFound:
    facts = read_facts(folder.parent if folder.suffix == ".toml" else folder)
    last = found.statuses[-1] if found.statuses else None
    return MassFound(
        stated_kg=drive.vehicle.mass_kg,
        found_kg=last.mass_kg if last else None,
        std_kg=last.mass_std_kg if last else None,
        true_kg=facts.last_mass_kg if facts else None,
    )


def _masses_kg(found: Driven) -> tuple[Floats, Floats]:
    known = [status for status in found.statuses if status.mass_kg is not None]
    times_s = np.array([status.t_ns for status in known], dtype=np.float64) * 1e-9
    return (
        found.estimates.at(times_s).distances_m,
        np.array([status.mass_kg for status in known], dtype=np.float64),
    )


def _resolutions(
    truths: Sequence[Reference | None],
    drivings: Sequence[Driving],
    resolutions_m: Sequence[float],
) -> list[Resolution]:
    """Each beside the truth, and beside the shortest bins."""
    finest_m = min(resolutions_m, default=0.0)
    return [
        Resolution(
            bin_m=bin_m,
            grade_pct=figures_of(
                np.concatenate(
                    [
                        _true_errors(truth, *driving.by_bin_m[bin_m])
                        for truth, driving in zip(truths, drivings, strict=True)
                    ]
                )
            ),
            differs_pct=figures_of(
                np.concatenate([_differs(driving, bin_m, finest_m) for driving in drivings])
            ),
        )
        for bin_m in sorted(resolutions_m)
    ]


def _true_errors(truth: Reference | None, times_s: Floats, grades_pct: Floats) -> Floats:
    return np.empty(0) if truth is None else grades_pct - truth.at(times_s).grades_pct


def _differs(driving: Driving, bin_m: float, finest_m: float) -> Floats:
    """Over the metres that both know."""
    times_s, grades_pct = driving.by_bin_m[bin_m]
    finest_s, finest_pct = driving.by_bin_m[finest_m]
    return grades_pct - np.interp(times_s, finest_s, finest_pct, left=np.nan, right=np.nan)
