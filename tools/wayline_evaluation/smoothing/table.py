"""Pure: the study as the paper's tables 1 to 4, its own figures beside in brackets."""

from collections.abc import Iterator

from rich.table import Table

from wayline_evaluation.drive_table import drive_table
from wayline_evaluation.smoothing.kalman import MPH_MPS
from wayline_evaluation.smoothing.modified_kalman import MILE_M
from wayline_evaluation.smoothing.printed import PRINTED, PRINTED_P_VALUES
from wayline_evaluation.smoothing.report import DistanceFigures, MethodReport, SmoothingReport
from wayline_evaluation.smoothing.statistics import ErrorFigures, Tested

SPEED_COLUMNS = (
    "ME\nmph",
    "bad signal\nmph",
    "acceleration\nME, mph/s",
    "VE",
    "MAE",
)
DISTANCE_COLUMNS = ("trips", "ME\nmile", "MAE\nmile", "p50\n%", "p95\n%", "max\n%", "t test\np")
NOTES_MAX = 20
"""Lines of notes that are shown; `--json` has all."""


def smoothing_tables(report: SmoothingReport) -> Iterator[Table]:
    """Tables 1 to 4, the trips' own distances by Wayline, and what was noticed."""
    yield _speeds(report)
    yield _t_tests(report)
    yield _distances(report)
    yield _contingency(report)
    if report.notes:
        yield _notes(report)


def _speeds(report: SmoothingReport) -> Table:
    judged = ", ".join(f"{count} by {kind}" for kind, count in report.references.items())
    title = (
        f"table 1: reference minus method, {report.fixes:,} fixes, {report.bad_fixes:,} bad, "
        f"trips judged {judged} (in brackets papers/003)"
    )
    table = drive_table(title, SPEED_COLUMNS, ("method",))
    for name, method in report.methods.items():
        printed = PRINTED.get(name)
        acceleration = method.acceleration_mps2
        table.add_row(
            name,
            _beside(_mean(method.speed_mps), printed and printed.speed_mph, 2),
            _beside(
                _mean(method.bad_signal_speed_mps), printed and printed.bad_signal_speed_mph, 1
            ),
            _beside(_mean(acceleration), printed and printed.acceleration_mean_mph, 5),
            _beside(_variance(acceleration), printed and printed.acceleration_variance, 4),
            _beside(_absolute(acceleration), printed and printed.acceleration_mae_mph, 4),
        )
    return table


def _t_tests(report: SmoothingReport) -> Table:
    title = "table 2: paired t tests of equal mean errors, p (in brackets papers/003)"
    table = drive_table(title, ("speed", "acceleration"), ("method", "beside"))
    for pair in report.pairs:
        printed = PRINTED_P_VALUES.get((pair.method_a, pair.method_b))
        speed, acceleration = printed or (None, None)
        table.add_row(
            pair.method_a,
            pair.method_b,
            _p_value(pair.delta_speed, speed),
            _p_value(pair.delta_acceleration, acceleration),
        )
    return table


def _distances(report: SmoothingReport) -> Table:
    title = "table 3: distance of a trip, reference minus method (in brackets papers/003)"
    table = drive_table(title, (*DISTANCE_COLUMNS, "in 2 std\n%"), ("method", "by"))
    for name, method in report.methods.items():
        printed = PRINTED.get(name)
        means = (printed.distance_mean_mile, printed.distance_mae_mile) if printed else (None, None)
        all_it_has = "all it has" if printed is None else "positions"
        table.add_row(name, all_it_has, *_distance_row(method, method.distance, *means))
    for name, method in report.methods.items():
        table.add_row(name, "speeds", *_distance_row(method, method.speed_distance, None, None))
    return table


def _distance_row(
    method: MethodReport, figures: DistanceFigures, mean_mile: float | None, mae_mile: float | None
) -> Iterator[str]:
    errors_m = figures.errors_m
    yield str(method.trips)
    yield _beside(errors_m.mean / MILE_M, mean_mile, 3)
    yield _beside(errors_m.mean_absolute / MILE_M, mae_mile, 3)
    yield from (f"{share:.2f}" for share in (figures.error_p50_pct, figures.error_p95_pct))
    yield f"{figures.error_max_pct:.1f}"
    yield _p_value(figures.against_reference, None)
    yield "" if figures.in_two_std is None else f"{100.0 * figures.in_two_std:.0f}"


def _contingency(report: SmoothingReport) -> Table:
    """Classes in which no trip lies are left out."""
    compared = {
        name: method.distance.by_mile
        for name, method in report.methods.items()
        if method.trips == len(report.trips)
    }
    critical = next(iter(compared.values())).critical
    title = f"table 4: trips by distance, their number and chi-square (critical: {critical:.2f})"
    table = drive_table(title, ("reference", *compared), ("miles",))
    for number, wanted in enumerate(report.reference_trips_by_mile):
        there = [(each.trips[number], each.cells[number]) for each in compared.values()]
        if wanted or any(trips for trips, _ in there):
            table.add_row(_miles(number), str(wanted), *(f"{n}  {cell:.2f}" for n, cell in there))
    totals = []
    for name, each in compared.items():
        printed = PRINTED.get(name)
        totals.append(_beside(each.chi2, printed and printed.chi2, 2))
    table.add_row("all", str(len(report.trips)), *totals)
    return table


def _miles(number: int) -> str:
    return "40 and more" if number == 40 else f"{number} to {number + 1}"


def _notes(report: SmoothingReport) -> Table:
    table = drive_table("noticed", ("",), ("trip",))
    lines = [(trip, note) for trip, notes in report.notes.items() for note in notes]
    for trip, note in lines[:NOTES_MAX]:
        table.add_row(trip, note)
    if len(lines) > NOTES_MAX:
        table.add_row("", f"and {len(lines) - NOTES_MAX:,} more (--json)")
    return table


def _beside(value: float | None, printed: float | None, digits: int) -> str:
    mine = "" if value is None else f"{value:.{digits}f}"
    return mine if printed is None else f"{mine} ({printed:.{digits}f})"


def _p_value(tested: Tested, printed: float | None) -> str:
    mine = "" if tested.p_value is None else f"{tested.p_value:.2g}"
    return mine if printed is None else f"{mine} ({printed:.2g})"


def _mean(figures: ErrorFigures | None) -> float | None:
    return None if figures is None else figures.mean / MPH_MPS


def _variance(figures: ErrorFigures | None) -> float | None:
    return None if figures is None else figures.variance / MPH_MPS**2


def _absolute(figures: ErrorFigures | None) -> float | None:
    return None if figures is None else figures.mean_absolute / MPH_MPS
