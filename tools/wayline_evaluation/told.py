"""Runs the yardstick on a simulated drive."""

from collections.abc import Sequence
from pathlib import Path

from wayline.drive import load_drive
from wayline.errors import InputError
from wayline_cli.stream import Outage
from wayline_evaluation.estimates import Estimates, Floats
from wayline_evaluation.replays import needed_truth
from wayline_evaluation.sensed import sense
from wayline_evaluation.yardstick_altitude import road_unrest_pct2_per_m
from wayline_evaluation.yardstick_run import told_estimates
from wayline_simulator.facts import read_facts


def told(folder: Path, outages: Sequence[Outage], poses_s: Floats) -> Estimates:
    """What is possible at these instants. Raises InputError where the noise is not known."""
    place = folder.parent if folder.suffix == ".toml" else folder
    facts = read_facts(place)
    if facts is None or facts.gps is None:
        mend = "leave --yardstick out, or simulate the drive with GPS"
        raise InputError(str(folder), "nothing is known of its GPS's noise", mend)
    drive = load_drive(folder)
    try:
        return told_estimates(
            poses_s,
            sense(drive, folder, outages),
            facts,
            # ingest took off what drive.toml says, which need not be the truth
            fixes_early_s=drive.vehicle.gps_latency_s - facts.gps.latency_s,
            grade_walk_pct2_per_m=road_unrest_pct2_per_m(needed_truth(folder)),
        )
    except ValueError as error:
        raise InputError(str(folder), str(error), "leave --yardstick out") from None
