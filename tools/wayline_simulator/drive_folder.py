"""Writes simulated runs as drive folders: what the devices wrote, and the truth beside it."""

from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import NamedTuple

import msgspec

from wayline.errors import InputError
from wayline.route import Route
from wayline.route_file import write_route
from wayline_simulator.bus_frames import bus_frames
from wayline_simulator.can_log import log_blocks
from wayline_simulator.course import repeated
from wayline_simulator.course_route import route_of
from wayline_simulator.damage import damaged_lines
from wayline_simulator.damaged_can_log import damaged_log
from wayline_simulator.drive_file import (
    CAN_NAME,
    DBC_NAME,
    NMEA_NAME,
    ROUTE_NAME,
    TRUTH_NAME,
    drive_toml,
)
from wayline_simulator.facts import Facts
from wayline_simulator.facts_file import write_facts
from wayline_simulator.happenings import happenings
from wayline_simulator.raw_epochs import measure_raw
from wayline_simulator.raw_errors import raw_errors
from wayline_simulator.raw_file import RAW_NAME, raw_lines, raw_source
from wayline_simulator.receiver import nmea_lines
from wayline_simulator.road import make_course
from wayline_simulator.scenario import Scenario
from wayline_simulator.simulation import Part, Run, randomness, simulate_run
from wayline_simulator.truth_file import write_truth
from wayline_simulator.vehicle_bus import dbc_text, signals


class Written(NamedTuple):
    """A drive that was written."""

    folder: Path
    duration_s: float
    distance_m: float


def simulate(
    scenario: Scenario,
    out: Path,
    *,
    beside: Path = Path(),
    written: Callable[[Written], None] = lambda _: None,
) -> list[Written]:
    """Write the scenario's only run into `out`, or its runs into `out/run-1`, `out/run-2`, ...

    A road's file is looked for from `beside`. `written` is told of each drive as it is done.
    Raises InputError for a road that cannot be and a folder that cannot be written.
    """
    lap = make_course(scenario.road, scenario.seed, beside)
    course = repeated(lap, scenario.road.laps)
    route = route_of(lap, f"{scenario.vehicle_id}-road", f"Simulated road ({scenario.road.kind})")
    drives = []
    for number in range(1, scenario.runs + 1):
        folder = out if scenario.runs == 1 else out / f"run-{number}"
        run = simulate_run(scenario, course, number)
        try:
            _write(run, scenario, route, folder)
        except OSError as error:
            reason = error.strerror or str(error)
            raise InputError(str(folder), reason, "name a folder that can be written") from None
        distance_m = float(run.journey.motion.path_m[-1])
        drives.append(Written(folder, run.journey.duration_s, distance_m))
        written(drives[-1])
    return drives


def _write(run: Run, scenario: Scenario, route: Route, folder: Path) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    _write_receiver(run, scenario, folder)
    database, mapped = dbc_text(run.models), signals(run.models)
    if mapped:
        (folder / DBC_NAME).write_text(database, encoding="ascii")
        _write_blocks(_can_log(run, scenario, database), folder / CAN_NAME)
    text = drive_toml(
        vehicle_id=scenario.vehicle_id,
        description=_description(scenario, run.number),
        signals=mapped,
        vehicle=run.assumed,
        has_gps=run.fixes is not None,
        raw=raw_source() if run.fixes is not None and scenario.raw is not None else None,
    )
    (folder / "drive.toml").write_text(text, encoding="utf-8")
    write_truth(run.journey, run.start_s, folder / TRUTH_NAME)
    write_route(route, folder / ROUTE_NAME)
    write_facts(_all_facts(run, scenario), folder)


def _write_receiver(run: Run, scenario: Scenario, folder: Path) -> None:
    fixes, gps = run.fixes, run.models.gps
    if fixes is None or gps is None:
        return
    random = randomness(scenario, run.number, Part.SENTENCE_DAMAGE)
    lines = damaged_lines(nmea_lines(fixes, gps), scenario.damage, random)
    _write_blocks(
        (b"%.3f %s\n" % (line.arrival_s, line.text) for line in lines), folder / NMEA_NAME
    )
    if scenario.raw is not None:
        random = randomness(scenario, run.number, Part.RAW)
        truth = run.journey.at(fixes.timestamps_s - run.start_s)
        errors = raw_errors(fixes, truth, gps, scenario.raw, random)
        measured = measure_raw(truth, fixes, gps, errors, scenario.raw.least_dbhz)
        _write_blocks(raw_lines(measured, gps.systems), folder / RAW_NAME)


def _all_facts(run: Run, scenario: Scenario) -> Facts:
    happened = happenings(run.journey, scenario.events, run.start_s, run.assumed.wheel_radius_m)
    return msgspec.structs.replace(run.facts, happenings=happened)


def _description(scenario: Scenario, number: int) -> str:
    what = scenario.description or f"A {scenario.vehicle} on a simulated road"
    return f"{what} (seed {scenario.seed}, run {number})"


def _can_log(run: Run, scenario: Scenario, database: str) -> Iterator[bytes]:
    frames = bus_frames(run.samples, database)
    if not scenario.damage.harms_frames:
        return log_blocks(frames, run.start_s)
    random = randomness(scenario, run.number, Part.FRAME_DAMAGE)
    return damaged_log(frames, run.start_s, scenario.damage, random)


def _write_blocks(blocks: Iterable[bytes], path: Path) -> None:
    with path.open("wb") as file:
        file.writelines(blocks)
