"""`bench timetable`: what reading a feed of a million stop_times costs beside Python's csv."""

import subprocess
import sys
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path

import msgspec

from wayline_bench.rounds import Say
from wayline_bench.row import Row, compared

TRIPS, STOPS = 25_000, 40
PATTERNS = 100
ROUNDS = 3
SECONDS_BAR, SECOND_START_BAR = 3.0, 0.1
MEMORY_ALLOWED_MB = 500.0


class Reading(msgspec.Struct, frozen=True):
    """What one process told of its reading."""

    seconds: float
    memory_mb: float
    rows: int


def bench(say: Say) -> list[Row]:
    """Every row; each reading is a process, by turns."""
    with tempfile.TemporaryDirectory(prefix="wayline-bench-") as temporary:
        folder = Path(temporary)
        say("writing a million rows")
        write_feed(folder / "feed")
        url = f"sqlite:///{folder / 'kept.db'}"
        _read("kept", folder / "feed", url)
        bare, ours, kept = [], [], []
        for number in range(ROUNDS):
            say(f"round {number + 1} of {ROUNDS}")
            bare.append(_read("csv", folder / "feed"))
            ours.append(_read("feed", folder / "feed"))
            kept.append(_read("kept", folder / "feed", url))
    over_mb = [one.memory_mb - other.memory_mb for one, other in zip(ours, bare, strict=True)]
    first_s, csv_s = ([each.seconds for each in readings] for readings in (ours, bare))
    second_s = [each.seconds for each in kept]
    return [
        compared(
            "a million stop_times, feed to timetable", first_s, csv_s, "csv.reader",
            unit="s", bar=SECONDS_BAR,
        ),
        compared(
            "memory over csv.reader's", over_mb, [MEMORY_ALLOWED_MB] * ROUNDS, "allowed",
            unit="MB", bar=1.0,
        ),
        compared(
            "second start, from the database", second_s, first_s, "first",
            unit="s", bar=SECOND_START_BAR,
        ),
    ]  # fmt: skip


def _read(what: str, feed: Path, *database: str) -> Reading:
    command = [sys.executable, "-m", "wayline_bench.timetable_reading", what, str(feed), *database]
    done = subprocess.run(command, check=True, capture_output=True)  # noqa: S603 -- our own
    reading = msgspec.json.decode(done.stdout, type=Reading)
    if reading.rows != TRIPS * STOPS:
        raise AssertionError(f"{what} read {reading.rows} rows of {TRIPS * STOPS}")
    return reading


def write_feed(folder: Path) -> None:
    """A feed of TRIPS trips of STOPS stops, on PATTERNS lines from south to north."""
    tables = {
        "routes": ["route_id,agency_id,route_short_name,route_type"]
        + [f"R{line},A,{line},3" for line in range(PATTERNS)],
        "stops": ["stop_id,stop_name,stop_lat,stop_lon"]
        + [
            f"S{line}-{at},Stop {at},{48.0 + 0.004 * at:.6f},{11.0 + 0.01 * line:.6f}"
            for line in range(PATTERNS)
            for at in range(STOPS)
        ],
        "trips": ["route_id,service_id,trip_id,direction_id,block_id"]
        + [f"R{trip % PATTERNS},S,T{trip},0,B{trip % 1000}" for trip in range(TRIPS)],
        "stop_times": ["trip_id,arrival_time,departure_time,stop_id,stop_sequence"],
    }
    tables["stop_times"] += [
        f"T{trip},{clock},{clock},S{trip % PATTERNS}-{at},{at + 1}"
        for trip in range(TRIPS)
        for at in range(STOPS)
        for clock in (clock_of(4 * 3600 + trip // PATTERNS * 240 + 90 * at),)
    ]
    write_tables(folder, tables)


def write_tables(folder: Path, tables: Mapping[str, Sequence[str]]) -> None:
    """A feed of these tables, by an agency in Berlin that runs service S every day of 2026."""
    folder.mkdir()
    always = {
        "agency": ["agency_id,agency_name,agency_url,agency_timezone", "A,A,x,Europe/Berlin"],
        "calendar": [
            "service_id,monday,tuesday,wednesday,thursday,friday,saturday,sunday,"
            "start_date,end_date",
            "S,1,1,1,1,1,1,1,20260101,20261231",
        ],
    }
    for name, lines in {**always, **tables}.items():
        (folder / f"{name}.txt").write_text("\n".join(lines) + "\n", encoding="utf-8")


def clock_of(seconds: int) -> str:
    """A time of the timetable."""
    return f"{seconds // 3600:02d}:{seconds // 60 % 60:02d}:{seconds % 60:02d}"
