"""The tables of `wayline evaluate slope` and `slope-map`."""

from collections.abc import Iterator

from rich.table import Table

from wayline_evaluation.drive_table import drive_table, number, percent
from wayline_evaluation.figures import Figures
from wayline_evaluation.slope import SlopeReport
from wayline_evaluation.slope_map_study import MapReport

WAY_COLUMNS = (
    *("shift, s", "rms", "p68", "p95", "mean", "in 1 std", "corr.", "hills, m"),
    *("spread", "rms of avg"),
)
MAP_COLUMNS = ("bins", "rms", "mean", "claimed std", "inside it", "hills, m", "flagged")


def slope_tables(report: SlopeReport) -> Iterator[Table]:
    """One row a way to know the grade; then resolutions and masses."""
    yield _ways(report)
    if report.resolutions:
        yield _resolutions(report)
    if any(mass.found_kg is not None for mass in report.masses):
        yield _masses(report)


def _ways(report: SlopeReport) -> Table:
    title = f"grade of {len(report.runs)} runs at {report.points} points, %, {_against(report)}"
    table = drive_table(title, WAY_COLUMNS, ("from",))
    for name, way in report.ways.items():
        table.add_row(
            name,
            f"{way.shift_s:g}",
            *_figures(way.grade_pct, "rms", "p68", "p95"),
            number(way.mean_pct, 3),
            percent(way.inside_share, 0),
            number(way.correlation, 3),
            number(way.hills_shift_m),
            number(way.spread_pct, 2),
            *_figures(way.mean_grade_pct, "rms"),
        )
    return table


def _against(report: SlopeReport) -> str:
    return "two by two" if report.against == "each other" else f"against the {report.against}"


def _resolutions(report: SlopeReport) -> Table:
    title = "map of single runs by the length of its bins, read at every metre, %"
    table = drive_table(title, ("rms", "p95", "differs, rms", "differs, at most"), ("bins, m",))
    for each in report.resolutions:
        table.add_row(
            f"{each.bin_m:g}",
            *_figures(each.grade_pct, "rms", "p95"),
            *_figures(each.differs_pct, "rms", "max"),
        )
    return table


def _masses(report: SlopeReport) -> Table:
    columns = ("stated", "found", "std", "true")
    table = drive_table("mass at the end of each run, kg", columns, ("run",))
    for run, mass in zip(report.runs, report.masses, strict=True):
        told = (mass.stated_kg, mass.found_kg, mass.std_kg, mass.true_kg)
        table.add_row(run, *(number(value, 0) for value in told))
    return table


def slope_map_tables(report: MapReport) -> Iterator[Table]:
    """One row a run."""
    table = drive_table("slope map after each run, %", MAP_COLUMNS, ("runs",))
    for each in report.after:
        figures = (number(value, 3) for value in (each.rms_pct, each.mean_pct, each.std_pct))
        beside = percent(each.inside_share, 0), number(each.hills_shift_m)
        table.add_row(f"{each.runs}", f"{each.bins}", *figures, *beside, f"{each.flagged_bins}")
    yield table


def _figures(figures: Figures | None, *names: str) -> Iterator[str]:
    for name in names:
        yield "" if figures is None else f"{getattr(figures, name):.2f}"
