"""Runs the yardstick on a simulated drive."""

from collections.abc import Sequence
from pathlib import Path

from wayline.drive_file import load_drive
from wayline.errors import InputError
from wayline_evaluation.estimates import Estimates, Floats
from wayline_evaluation.replays import needed_truth
from wayline_evaluation.sensed import without_fixes
from wayline_evaluation.sensed_drive import sense
from wayline_evaluation.yardstick_altitude import road_unrest_pct2_per_m
from wayline_evaluation.yardstick_run import told_estimates
from wayline_replay.outages import Outage
from wayline_simulator.facts import Facts
from wayline_simulator.facts_file import read_facts


def needed_facts(folder: Path) -> Facts:
    """What a drive was simulated with. Raises InputError for one without GPS, or a recorded one."""
    facts = read_facts(folder.parent if folder.suffix == ".toml" else folder)
    if facts is None or facts.gps is None or facts.gyro is None or facts.odometer is None:
        mend = "leave --yardstick out, or simulate a drive with GPS, gyro and odometer"
        raise InputError(str(folder), "the noise of its sensors is not known", mend)
    return facts


def told_of_all(folders: Sequence[Path]) -> None:
    """Raise InputError before a long study for what it would end with."""
    for folder in folders:
        needed_facts(folder)


def told(folder: Path, outages: Sequence[Outage], poses_s: Floats) -> Estimates:
    """What is possible at these instants. Raises InputError where the noise is not known."""
    facts, drive = needed_facts(folder), load_drive(folder)
    sensed = without_fixes(sense(drive, folder), outages)
    if not sensed.fixes:
        raise InputError(str(folder), "has no fix for the yardstick", "leave --yardstick out")
    true_latency_s = facts.gps.latency_s if facts.gps else 0.0
    return told_estimates(
        poses_s,
        sensed,
        facts,
        # ingest took off what drive.toml says, which need not be the truth
        fixes_early_s=drive.vehicle.gps_latency_s - true_latency_s,
        grade_walk_pct2_per_m=road_unrest_pct2_per_m(needed_truth(folder)),
    )
