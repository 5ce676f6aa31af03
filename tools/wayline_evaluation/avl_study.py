"""`wayline evaluate avl`: runs the published route filter on the tables of papers/000."""

import csv
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import NamedTuple, TypeVar

from wayline.errors import InputError
from wayline.route import Route
from wayline.route_file import load_route
from wayline_cli.route_import import Wishes, import_route
from wayline_eta.avl_filter import AvlRouteFilter, Estimate
from wayline_evaluation.avl import AvlReport, Printed, Sample, avl_report

SAMPLES, PRINTED = "avl-gps-samples.csv", "avl-ekf-estimates.csv"
PLANNED = "avl-planned-route.csv"
MEND = "name a folder with the tables of papers/000"

Row = TypeVar("Row")


class AvlStudy(NamedTuple):
    """The report, and what a picture of it needs."""

    report: AvlReport
    route: Route
    samples: Sequence[Sample]
    estimates: Sequence[Estimate]


def avl_study(folder: Path, route_path: Path | None = None) -> AvlStudy:
    """`route_path` is a route to follow in place of the planned one. Raises InputError."""
    if route_path is None:
        route = import_route(folder / PLANNED, Wishes("planned", "Planned route", loop=False))
    else:
        route = load_route(route_path)
    samples = _read(folder / SAMPLES, _sample)
    printed = _read(folder / PRINTED, _printed)
    if not samples or printed[-1].row > len(samples):
        raise InputError(str(folder / PRINTED), "rows of fixes that are not there", MEND)
    filter_ = AvlRouteFilter(route)
    estimates = [
        estimate
        for sample in samples
        if (estimate := filter_.step(None if sample.is_repeat else sample[:2])) is not None
    ]
    if len(estimates) != len(samples):
        raise InputError(str(folder / SAMPLES), "begins with a row that is no fix", MEND)
    return AvlStudy(avl_report(samples, estimates, printed), route, samples, estimates)


def _sample(row: dict[str, str]) -> Sample:
    return Sample(float(row["latitude_deg"]), float(row["longitude_deg"]), row["is_repeat"] != "0")


def _printed(row: dict[str, str]) -> Printed:
    where = float(row["latitude_deg"]), float(row["longitude_deg"])
    return Printed(int(row["gps_row_inferred"]), *where)


def _read(path: Path, parse: Callable[[dict[str, str]], Row]) -> list[Row]:
    try:
        with path.open(encoding="utf-8-sig", newline="") as file:
            rows = [parse(row) for row in csv.DictReader(file)]
    except OSError as error:
        raise InputError(str(path), f"cannot be read ({error.strerror})", MEND) from None
    except (KeyError, ValueError, TypeError) as error:
        raise InputError(str(path), f"is no such table ({error})", MEND) from None
    if not rows:
        raise InputError(str(path), "is empty", MEND)
    return rows
