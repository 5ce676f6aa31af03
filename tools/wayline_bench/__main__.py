"""`scripts/bench [NAME...]`: runs benches and prints their tables."""

import argparse
import sys
from collections.abc import Callable
from functools import partial
from pathlib import Path

import msgspec
from rich.console import Console

from wayline_bench import eta, fleet, fusion, history, ingest, raw, slope, smoothing, timetable
from wayline_bench.rounds import Say
from wayline_bench.row import Row, table

Bench = Callable[[Say], list[Row]]
BENCHES: dict[str, Bench] = {
    "fusion": fusion.bench,
    "ingest": ingest.bench,
    "eta": eta.bench,
    "fleet": fleet.bench,
    "history": history.bench,
    "raw": raw.bench,
    "timetable": timetable.bench,
    "slope": slope.bench,
    "smoothing": smoothing.bench,
}


def main() -> None:
    """Run the benches named, or all; status 1 where a bar is missed."""
    parser = argparse.ArgumentParser(prog="scripts/bench", description=__doc__)
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"of {', '.join(BENCHES)}")
    parser.add_argument("--json", type=Path, metavar="FILE", help="write the rows there too")
    parser.add_argument(
        "--vehicles", type=int, nargs="+", default=[], metavar="N", help="fleet: only such sizes"
    )
    options = parser.parse_args()
    unknown = set(options.names) - BENCHES.keys()
    if unknown:
        parser.error(f"no bench {', '.join(sorted(unknown))}; there are: {', '.join(BENCHES)}")
    benches = BENCHES | {"fleet": partial(fleet.bench, vehicles=options.vehicles)}
    results = {name: run(name, benches[name]) for name in options.names or BENCHES}
    if options.json:
        options.json.write_bytes(msgspec.json.format(msgspec.json.encode(results)))
    sys.exit(not all(row.holds for rows in results.values() for row in rows))


def run(name: str, bench: Bench) -> list[Row]:
    """The rows of a bench, shown; what it does meanwhile is seen on a terminal."""
    console = Console(stderr=True)
    with console.status(name) as status:
        rows = bench(lambda progress: status.update(f"{name}: {progress}"))
    print(f"{name}\n\n{table(rows)}")
    return rows


if __name__ == "__main__":
    main()
