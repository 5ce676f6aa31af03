"""Simulates drives of the shipped scenarios, replays and scores them."""

import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import NamedTuple

from wayline_evaluation.outages import OutageScore, score_outage
from wayline_evaluation.pose_errors import PoseErrors, compared
from wayline_evaluation.reference import Reference
from wayline_evaluation.replay_result import Replayed
from wayline_evaluation.replays import Progressed, done_by, needed_truth, read_replay
from wayline_evaluation.scenario_bars import (
    canyon_ratio,
    cluster,
    fix_errors_m,
    moved_m,
    start,
    surrounded,
    trip,
    worst_m,
)
from wayline_evaluation.scenario_plan import StudyDrive, outages_within
from wayline_evaluation.studied import Bars, Studied
from wayline_evaluation.told import told
from wayline_replay.outages import Outage
from wayline_replay.replay import Summary, replay
from wayline_simulator.course import Surroundings
from wayline_simulator.drive_folder import simulate
from wayline_simulator.facts_file import read_facts
from wayline_simulator.happenings import Happenings
from wayline_simulator.scenario import Scenario, overlaid
from wayline_simulator.scenario_file import load_scenario


class Task(NamedTuple):
    """One drive, and where to write it."""

    drive: StudyDrive
    folder: Path


class Outcome(NamedTuple):
    """One replay beside the truth."""

    scenario: Scenario
    happened: Happenings
    truth: Reference
    run: Replayed
    summary: Summary
    errors: PoseErrors


def study(
    drives: Sequence[StudyDrive], out: Path, jobs: int, progressed: Progressed
) -> list[Studied]:
    """All drives, in folders of `out`. Raises InputError."""
    tasks = [Task(drive, out / drive.name) for drive in drives]
    return list(done_by(_studied, tasks, jobs, progressed))


def _studied(task: Task) -> Studied:
    drive, folder = task
    scenario = _scenario(drive)
    simulate(scenario, folder)
    facts, truth = read_facts(folder), needed_truth(folder)
    run, summary = _replayed(folder, ())
    errors = {"fusion": compared(run.estimates, truth)}
    can_be_told = facts is not None and facts.gyro is not None and facts.odometer is not None
    if can_be_told:
        errors["yardstick"] = compared(told(folder, (), run.estimates.times_s), truth)
    happened = Happenings() if facts is None else facts.happenings
    outcome = Outcome(scenario, happened, truth, run, summary, errors["fusion"])
    bars = BARS[drive.scenario](outcome) if drive.scenario in BARS else {}
    outages, blind = _outages(folder, run, truth) if drive.plan.outages else ((), {})
    return Studied(drive, float(truth.distances_m[-1]), errors, outages, blind, bars)


def _scenario(drive: StudyDrive) -> Scenario:
    plan = drive.plan
    of_road = {"length_m": plan.length_m, "laps": plan.laps}
    asked = {key: value for key, value in of_road.items() if value is not None}
    overlay: dict[str, object] = {"seed": drive.seed, "runs": 1}
    return overlaid(load_scenario(drive.scenario), overlay | ({"road": asked} if asked else {}))


def _replayed(folder: Path, outages: Sequence[Outage]) -> tuple[Replayed, Summary]:
    with tempfile.TemporaryDirectory(prefix="wayline-study-") as temporary:
        summary = replay(folder, Path(temporary), outages=outages)
        return read_replay(folder, Path(temporary)), summary


def _outages(
    folder: Path, whole: Replayed, truth: Reference
) -> tuple[tuple[OutageScore, ...], dict[str, PoseErrors]]:
    outages = outages_within(whole.end_s - whole.start_s)
    run, _ = _replayed(folder, outages)
    filters = {
        "fusion": run.estimates,
        "yardstick": told(folder, outages, run.estimates.times_s),
    }
    scores = [
        score_outage(
            outage,
            drive=run.drive,
            name=name,
            pass_number=1,
            drive_start_s=run.start_s,
            estimates=estimates,
            reference=truth,
        )
        for name, estimates in filters.items()
        for outage in outages
    ]
    errors = {name: compared(estimates, truth) for name, estimates in filters.items()}
    blind = {name: each.where(each.dead_reckoning) for name, each in errors.items()}
    return tuple(score for score in scores if score is not None), blind


def _displaced(outcome: Outcome) -> Bars:
    sizes_m = [
        (event.east_m**2 + event.north_m**2) ** 0.5
        for event in outcome.scenario.events.displacements
    ]
    # the drive may end before the last of them
    return {
        f"{size_m:.0f} m moves": moved_m(outcome.errors, span)
        for size_m, span in zip(sizes_m, outcome.happened.displaced, strict=False)
    }


def _cluster(outcome: Outcome) -> Bars:
    found = cluster(outcome.errors, outcome.happened.displaced[0])
    return {"pull, m": found.pull_m, "good fixes win, s": found.recovery_s}


def _canyon(outcome: Outcome) -> Bars:
    canyons = surrounded(outcome.happened, Surroundings.CANYON, float(outcome.truth.times_s[-1]))
    times_s, fixes_m = fix_errors_m(outcome.run.fixes, outcome.truth)
    return {"p95 over fixes'": canyon_ratio(outcome.errors, times_s, fixes_m, canyons)}


def _garage(outcome: Outcome) -> Bars:
    inside = surrounded(outcome.happened, Surroundings.GARAGE, float(outcome.truth.times_s[-1]))
    return {"worst inside, m": worst_m(outcome.errors, inside)}


def _cold_start(outcome: Outcome) -> Bars:
    first = next(fix for fix in outcome.run.fixes if fix.valid)
    found = start(outcome.errors, first.t_ns * 1e-9)
    return {
        "10 s after the first fix, m": found.horizontal_m,
        "deg": found.heading_deg,
        "m/s": found.speed_mps,
    }


def _gps_only(outcome: Outcome) -> Bars:
    _, fixes_m = fix_errors_m(outcome.run.fixes, outcome.truth)
    found = trip(outcome.run.estimates, outcome.errors, fixes_m, outcome.truth)
    return {
        "RMS over fixes'": found.position_ratio,
        "speed RMS, m/s": found.speed_mps,
        "trip, %": found.distance_pct,
    }


def _damaged(outcome: Outcome) -> Bars:
    return {
        "bad inputs counted": float(sum(outcome.summary.bad_input.values())),
        "poses": float(outcome.summary.counts["pose"]),
    }


BARS: dict[str, Callable[[Outcome], Bars]] = {
    "displaced-fixes": _displaced,
    "cluster-after-blackout": _cluster,
    "canyon": _canyon,
    "garage": _garage,
    "cold-start": _cold_start,
    "gps-only": _gps_only,
    "damaged-input": _damaged,
}
