"""Reads a feed once, in a process of its own, and says the seconds and the peak of its memory.

`python -m wayline_bench.timetable_reading csv|feed|kept FEED [DATABASE_URL]`
"""

import csv
import json
import re
import sys
import time
from pathlib import Path

from wayline.timetable.loading import load_timetable

KB_PER_MB = 1024.0
STATUS = Path("/proc/self/status")
"""Its VmHWM is the peak since this program began; getrusage counts its parent's, too."""


def rows_by_csv(feed: Path) -> int:
    """Every row of stop_times as a list of texts, as Python's own reader makes them."""
    with (feed / "stop_times.txt").open(newline="", encoding="utf-8") as file:
        return sum(1 for _ in csv.reader(file)) - 1


def main() -> None:
    """Print one line of JSON."""
    what, feed, *database = sys.argv[1:]
    started_s = time.perf_counter()
    if what == "csv":
        rows = rows_by_csv(Path(feed))
    else:
        timetable = load_timetable(Path(feed), database[0] if database else None)
        stops = [len(pattern.stops) for pattern in timetable.patterns]
        rows = sum(stops[trip.pattern] for trip in timetable.trips)
    seconds = time.perf_counter() - started_s
    print(json.dumps({"seconds": seconds, "memory_mb": _peak_mb(), "rows": rows}))


def _peak_mb() -> float:
    found = re.search(r"VmHWM:\s+(\d+) kB", STATUS.read_text(encoding="ascii"))
    assert found is not None  # noqa: S101  # Linux tells it of every process
    return int(found[1]) / KB_PER_MB


if __name__ == "__main__":
    main()
