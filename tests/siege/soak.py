"""The whole system for long, many times as fast as life: `soak.py --minutes 20 --speed 20`."""

import argparse
import os
import statistics
import tempfile
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

from wayline.bus import open_session
from wayline.messages import Health
from wayline.services import SERVICES
from wayline_bench.fleet_page import open_page
from wayline_cli.listener import Listener
from wayline_cli.local_system import LocalSystem
from wayline_simulator.drive_folder import simulate
from wayline_simulator.scenario_file import load_scenario

SCENARIO, VEHICLE = "demo-truck", "hill-truck"
START_S = 60.0
SAMPLES = 240
"""Of each process, evenly over the whole time."""
MEMORY_GROWTH, MEMORY_GROWTH_BYTES = 0.03, 2_000_000
"""Of the last quarter over the second; the allocator's own breath is less."""
FILES_GROWTH = 2
PAGE_BYTES = os.sysconf("SC_PAGE_SIZE")


class Sample(NamedTuple):
    """What a process held at an instant."""

    memory_bytes: int
    """Resident."""
    files: int
    """Open handles."""


def sample(pid: int) -> Sample:
    """What a process holds now."""
    resident = int(Path(f"/proc/{pid}/statm").read_text().split()[1])
    return Sample(resident * PAGE_BYTES, len(list(Path(f"/proc/{pid}/fd").iterdir())))


class Growth(NamedTuple):
    """Medians of the second and of the last quarter."""

    memory_bytes: tuple[float, float]
    files: tuple[float, float]

    @property
    def is_flat(self) -> bool:
        """Whether the process holds in the end what it held after the first quarter."""
        (then, now), (files_then, files_now) = self
        room = max(MEMORY_GROWTH * then, MEMORY_GROWTH_BYTES)
        return now - then <= room and files_now - files_then <= FILES_GROWTH


def growth(samples: list[Sample]) -> Growth:
    """How a process has grown since the first quarter; at least four samples."""
    quarter = len(samples) // 4
    second, last = samples[quarter : 2 * quarter], samples[-quarter:]

    def medians(held: Callable[[Sample], int]) -> tuple[float, float]:
        return statistics.median(map(held, second)), statistics.median(map(held, last))

    return Growth(medians(lambda each: each.memory_bytes), medians(lambda each: each.files))


def soaked(folder: Path, seconds: float, speed: float) -> dict[str, Growth]:
    """Play a drive of receiver and buses over and over; how each process has grown."""
    drive = folder / "drive"
    simulate(load_scenario(SCENARIO), drive)
    route, database = drive / "route.geojson", folder / "wayline.db"
    options = {"routes": [str(route)], "database_url": f"sqlite:///{database}"}
    with LocalSystem(folder, vehicles=["*"], **options) as system:
        system.start_router()
        playing = ("--drive", str(drive), "--speed", f"{speed:g}", "--loop")
        for name, row in SERVICES.items():
            system.start(name, *(playing if row.reads_sensors else ()))
        with open_session(system.bus) as session:
            healths = Listener(session, "*", ("health",))
            alive = Listener(session, VEHICLE, ("progress",))
            alive.await_message("progress", timeout_s=START_S)
            with open_page(system.url("dashboard"), VEHICLE):
                found = _watched(system, seconds)
            assert all(system.is_running(name) for name in found)
            for listener in (healths, alive):
                listener.close()
        _say_what_was_done([each.message for each in healths.heard("health")])
    return found


def _watched(system: LocalSystem, seconds: float) -> dict[str, Growth]:
    samples: dict[str, list[Sample]] = {name: [] for name in ("router", *SERVICES)}
    started_s, pause = time.monotonic(), threading.Event()
    for number in range(1, SAMPLES + 1):
        pause.wait(started_s + number * seconds / SAMPLES - time.monotonic())
        for name, taken in samples.items():
            taken.append(sample(system.pid(name)))
    return {name: growth(taken) for name, taken in samples.items()}


def _say_what_was_done(healths: list[object]) -> None:
    said = [each for each in healths if isinstance(each, Health)]
    for name in SERVICES:
        own = [each for each in said if each.service == name]
        rates_hz = (
            statistics.median(each.in_rate_hz for each in own),
            statistics.median(each.out_rate_hz for each in own),
        )
        lags_ms = [each.lag_ms_p99 for each in own if each.lag_ms_p99 is not None]
        print(
            f"{name}: {rates_hz[0]:.0f} messages in and {rates_hz[1]:.0f} out a second, "
            f"{max(lags_ms, default=0.0):.0f} ms late at most (p99), "
            f"{own[-1].dropped} dropped, {own[-1].bad_input} bad"
        )


def main() -> None:
    """Run the command."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--minutes", type=float, default=20.0)
    parser.add_argument("--speed", type=float, default=20.0, help="times as fast as driven")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        grown = soaked(Path(folder), 60.0 * options.minutes, options.speed)
    for name, each in grown.items():
        (then, now), (files_then, files_now) = each
        print(
            f"{name}: {then / 1e6:.1f} MB in the second quarter, {now / 1e6:.1f} MB in the last; "
            f"{files_then:.0f} and {files_now:.0f} files"
        )
    if growing := [name for name, each in grown.items() if not each.is_flat]:
        raise SystemExit(f"siege: not flat after the first quarter: {', '.join(growing)}")


if __name__ == "__main__":
    main()
