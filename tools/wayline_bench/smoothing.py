"""`bench smoothing`: what the smoothing study costs beside reading the trips' files as numbers."""

import csv
import tempfile
from pathlib import Path

from wayline_bench.rounds import Say, in_turns
from wayline_bench.row import Row, compared
from wayline_evaluation.smoothing.study import smoothing_study
from wayline_simulator.trips.files import simulate_trips
from wayline_simulator.trips.model import TripsModel

VEHICLES, TRIPS = 7, 15
STUDIED = 2
"""Times that every trip is taken: making them costs more than studying them."""
FUSED = 1
"""Trips that fusion is run on: of a thousand trips it would be five."""
ROUNDS = 3
BAR = 20.0


def bench(say: Say) -> list[Row]:
    """One row; CPU seconds."""
    with tempfile.TemporaryDirectory(prefix="wayline-bench-") as temporary:
        say(f"making {VEHICLES * TRIPS} trips")
        made = simulate_trips(TripsModel(vehicles=VEHICLES, trips=TRIPS), Path(temporary))
        folders = [trip.folder for trip in made] * STUDIED
        seconds = in_turns(
            {
                "study": lambda: smoothing_study(folders, FUSED, 1, lambda _, __: None),
                "csv": lambda: [read_numbers(folder) for folder in folders],
            },
            ROUNDS,
            say,
        )
    what = f"smoothing study of {len(folders)} trips"
    return [
        compared(what, seconds["study"], seconds["csv"], "csv.reader, numbers", unit="s", bar=BAR)
    ]


def read_numbers(folder: Path) -> int:
    """Every cell of a trip's fixes and truth as a number; returns how many."""
    count = 0
    for path in folder.glob("*.csv"):
        with path.open(newline="", encoding="ascii") as file:
            rows = csv.reader(file)
            next(rows)
            for row in rows:
                count += len([float(cell) for cell in row])
    return count
