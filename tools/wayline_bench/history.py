"""`bench history`: a fleet's hour kept in fast play, and what is asked of the past then.

The hour goes through the service's own loop, cores and store, without the bus, whose cost is
`bench fleet`'s. Where a PostgreSQL is named in WAYLINE_BENCH_POSTGRES, it is measured too.
"""

import os
import tempfile
from collections.abc import Iterator
from pathlib import Path

from wayline.database import open_database
from wayline_bench.history_drives import drive
from wayline_bench.history_hour import FLEET, HOUR_S, KeptHour, keep_hour
from wayline_bench.history_reading import BareTrack, day_of, fill, filled_days
from wayline_bench.rounds import Say, in_turns
from wayline_bench.row import Row, compared
from wayline_history.chunk import Chunk, chunk_of, encoded
from wayline_history.layouts import NULL, POSES
from wayline_history.store import ROW_BYTES
from wayline_history.thinning import thinned

FAST_PLAY = 20.0
"""Times real time."""
POSE_BYTES_BAR, TRACK_BAR, YEAR_BAR, MEMORY_BAR = 40.0, 3.0, 1.5, 1.2
ROUNDS = 5
WEEK_DAYS, YEAR_DAYS = 7, 365
POSTGRES = "WAYLINE_BENCH_POSTGRES"


def bench(say: Say) -> list[Row]:
    """Every row."""
    with tempfile.TemporaryDirectory(prefix="wayline-bench-") as temporary:
        folder = Path(temporary)
        rows = [row for kind, url in _databases(folder) for row in _hour(kind, url, say)]
        return [*rows, *_sizes(), *_answers(folder, say)]


def _databases(folder: Path) -> Iterator[tuple[str, str]]:
    yield "SQLite", f"sqlite:///{folder / 'hour.db'}"
    if url := os.environ.get(POSTGRES):
        yield "PostgreSQL", url


def _hour(kind: str, url: str, say: Say) -> list[Row]:
    kept: KeptHour = keep_hour(url, lambda done: say(f"{kind}: {done:.0%} of an hour"))
    hour = f"an hour of {FLEET} vehicles at 1 Hz, {kind}"
    allowed_s = HOUR_S / FAST_PLAY
    memory = compared(
        f"memory after it, {kind}", [kept.last_mb], [kept.first_mb], "after a quarter",
        unit="MB", bar=MEMORY_BAR,
    )  # fmt: skip
    spent = compared(
        hour, [kept.cpu_s], [allowed_s], f"of CPU for {FAST_PLAY:.0f} times real time",
        unit="s", bar=1.0,
    )  # fmt: skip
    return [spent, memory]


def _sizes() -> list[Row]:
    hour = _poses(int(HOUR_S))
    left = thinned(hour)
    ours = [(len(encoded(left)) + ROW_BYTES) / len(left)]
    per_second = [(len(encoded(left)) + ROW_BYTES) / len(hour)]
    return [
        compared("a pose after thinning", ours, [POSE_BYTES_BAR], "allowed", unit="B", bar=1.0),
        compared("a second after thinning", per_second, ours, "of a pose that stays", unit="B"),
    ]


def _poses(seconds: int) -> Chunk:
    return chunk_of(POSES, [POSES.row(pose, {}, engine=NULL) for pose in drive(seconds)])


def _answers(folder: Path, say: Say) -> list[Row]:
    week, year = (f"sqlite:///{folder / f'{name}.db'}" for name in ("week", "year"))
    for url, days in ((week, WEEK_DAYS), (year, YEAR_DAYS)):
        engine = open_database(url, "wayline_history")
        for number in fill(engine, days):
            say(f"filling {number} of {days} days")
        engine.dispose()
    bare = BareTrack(folder / "bare.db", filled_days(week))
    readers = {
        "week": day_of(week, WEEK_DAYS // 2),
        "year": day_of(year, YEAR_DAYS // 2),
        "bare": bare.read,
    }
    spent = in_turns(readers, ROUNDS, say)
    return [
        compared(
            "a day's track of one vehicle, JSON", spent["week"], spent["bare"],
            "indexed query of as many rows", unit="s", bar=TRACK_BAR,
        ),
        compared(
            "a day out of a year", spent["year"], spent["week"], "out of a week",
            unit="s", bar=YEAR_BAR,
        ),
    ]  # fmt: skip
