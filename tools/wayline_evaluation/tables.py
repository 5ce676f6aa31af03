"""Reports as tables for people."""

from collections.abc import Iterator, Sequence

from rich.table import Table

from wayline_evaluation.accuracy import AccuracyReport, DriveAccuracy
from wayline_evaluation.architectures import ArchitectureRow, architecture_rows, paper_rows
from wayline_evaluation.figures import Consistency, Errors, Figures, Inside
from wayline_evaluation.outages import OutageReport, OutageScore

QUANTITIES = {
    "horizontal_m": "horizontal, m",
    "cross_track_m": "cross-track, m",
    "along_track_m": "along-track, m",
    "heading_deg": "heading, deg",
    "speed_mps": "speed, m/s",
    "alt_m": "altitude, m",
    "grade_pct": "grade, %",
}
CHECKED = ("east", "north", "ellipse", "heading", "speed", "alt", "grade")
LISTED_MAX = 40
"""More outages are summed up only; the JSON file has all."""


def accuracy_tables(report: AccuracyReport) -> Iterator[Table]:
    """A drive each, and all pooled where there are several."""
    for drive in (*report.drives, *([report.pooled] if len(report.drives) > 1 else [])):
        yield _errors_table(drive)
        if drive.reference == "truth":
            yield _consistency_table(drive)
        if drive.ratios:
            yield _ratio_table(drive)


def _errors_table(drive: DriveAccuracy) -> Table:
    against = "the truth" if drive.reference == "truth" else "its own fixes"
    table = _table(f"{drive.drive}: errors against {against}")
    for name in ("filter", "poses", "error"):
        table.add_column(name)
    for name in ("rms", "p50", "p68", "p95", "max"):
        table.add_column(name, justify="right")
    for name, accuracy in drive.filters.items():
        for part, found in accuracy.parts.items():
            for row in _error_rows(found.errors):
                table.add_row(name, part.replace("_", " "), *row)
        share = accuracy.parts["all"].within_15_m_share
        table.add_row(name, "all", "within 15 m", *[""] * 4, f"{100.0 * share:.1f} %")
        missing = f"{100.0 * accuracy.missing_share:.1f} %"
        table.add_row(name, "all", "without position", *[""] * 4, missing, end_section=True)
    return table


def _error_rows(errors: Errors) -> Iterator[list[str]]:
    for name, title in QUANTITIES.items():
        figures = getattr(errors, name)
        if figures is not None:
            yield [title, *(f"{value:.2f}" for value in _shown(figures))]


def _shown(figures: Figures) -> tuple[float, ...]:
    return figures.rms, figures.p50, figures.p68, figures.p95, figures.max


def _consistency_table(drive: DriveAccuracy) -> Table:
    table = _table(f"{drive.drive}: percent inside 1 sigma (68.3) and 2 sigma (95.4)")
    for name in ("filter", "poses", *CHECKED, "NEES (2)"):
        table.add_column(name, justify="left" if name in ("filter", "poses") else "right")
    for name, accuracy in drive.filters.items():
        for part, found in accuracy.parts.items():
            if found.consistency is not None:
                table.add_row(name, part.replace("_", " "), *_consistency_row(found.consistency))
    return table


def _consistency_row(consistency: Consistency) -> Iterator[str]:
    for name in CHECKED:
        inside: Inside | None = getattr(consistency, name)
        if inside is None:
            yield ""
        else:
            yield f"{100.0 * inside.one_sigma:.0f}/{100.0 * inside.two_sigma:.0f}"
    yield "" if consistency.nees_mean is None else f"{consistency.nees_mean:.2f}"


def _ratio_table(drive: DriveAccuracy) -> Table:
    table = _table(f"{drive.drive}: fusion's figures over the yardstick's")
    table.add_column("poses")
    table.add_column("error")
    for name in ("rms", "p50", "p68", "p95", "max"):
        table.add_column(name, justify="right")
    for part, errors in drive.ratios.items():
        for row in _error_rows(errors):
            table.add_row(part.replace("_", " "), row[0].partition(",")[0], *row[1:])
    return table


def outage_tables(report: OutageReport) -> Iterator[Table]:
    """Every outage as papers/001 table 1, then the summary."""
    if len(report.outages) <= LISTED_MAX:
        yield _outages_table(report.outages)
    yield _summary_table(report)


def _outages_table(outages: Sequence[OutageScore]) -> Table:
    table = _table("errors at the last instant before GPS returns")
    table.add_column("drive")
    table.add_column("filter")
    for name in ("start\ns", "lasts\ns", "distance\nm", "cross-track\nm", "along-track\nm"):
        table.add_column(name, justify="right")
    for name in ("horizontal\nm", "\n%", "heading\ndeg"):
        table.add_column(name, justify="right")
    for score in outages:
        measures = (
            score.distance_m,
            score.cross_track_m,
            score.along_track_m,
            score.horizontal_m,
            score.horizontal_pct,
            score.heading_deg,
        )
        table.add_row(
            score.drive,
            score.filter,
            f"{score.start_s:.0f}",
            f"{score.duration_s:g}",
            *("" if value is None else f"{value:.1f}" for value in measures),
        )
    return table


def _summary_table(report: OutageReport) -> Table:
    against = "the truth" if report.reference == "truth" else "the recorded fixes"
    table = _table(f"outages of GPS, against {against}")
    for name in ("filter", "lasts\ns", "pass", "outages", "error"):
        table.add_column(name, no_wrap=True)
    for name in ("rms", "p50", "p68", "p90", "p95", "max"):
        table.add_column(name, justify="right")
    for each in report.passes:
        if each.horizontal_m is not None:
            row = [
                each.filter,
                f"{each.duration_s:g}",
                f"from {each.first_s:g} s",
            ]
            table.add_row(
                *row, str(each.horizontal_m.count), "horizontal, m", *_cells(each.horizontal_m)
            )
    for summary in report.summaries:
        for name, title in (
            ("horizontal_m", "horizontal, m"),
            ("horizontal_pct", "horizontal, %"),
            ("cross_track_m", "cross-track, m"),
            ("cross_track_pct", "cross-track, %"),
            ("along_track_m", "along-track, m"),
            ("heading_deg", "heading, deg"),
        ):
            figures: Figures | None = getattr(summary, name)
            if figures is not None:
                row = [summary.filter, f"{summary.duration_s:g}", "all", str(figures.count), title]
                table.add_row(*row, *_cells(figures))
    for duration, ratio in report.ratios.items():
        table.add_row("ratio", duration, "all", "", "horizontal", *_cells(ratio))
    return table


def architecture_tables(report: OutageReport) -> Iterator[Table]:
    """One row an architecture and duration, papers/001's own outages beneath."""
    against = "the truth" if report.reference == "truth" else "the recorded fixes"
    table = _table(f"outages of GPS by architecture, errors at their end against {against}")
    table.add_column("architecture", no_wrap=True)
    for name in ("lasts\ns", "outages\n", "distance\nmean, m", "horizontal, m\np50", "\np90"):
        table.add_column(name, justify="right")
    for name in ("horizontal, %\np50", "\np90", "cross-track\nmean, m", "\nmean, %"):
        table.add_column(name, justify="right")
    table.add_column("heading, deg\np50", justify="right")
    for row in (*architecture_rows(report.outages), *paper_rows()):
        table.add_row(*_architecture_cells(row))
    yield table


def _architecture_cells(row: ArchitectureRow) -> Iterator[str]:
    yield from (row.architecture, f"{row.duration_s:g}", str(row.count), f"{row.distance_m:.0f}")
    for figures in (row.horizontal_m, row.horizontal_pct):
        yield "" if figures is None else f"{figures.p50:.1f}"
        yield "" if figures is None else f"{figures.p90:.1f}"
    yield f"{row.cross_track_m:.1f}"
    yield "" if row.cross_track_pct is None else f"{row.cross_track_pct:.1f}"
    yield "" if row.heading_deg is None else f"{row.heading_deg.p50:.1f}"


def _cells(figures: Figures) -> Iterator[str]:
    for name in ("rms", "p50", "p68", "p90", "p95", "max"):
        yield f"{getattr(figures, name):.1f}"


def _table(title: str) -> Table:
    return Table(title=title, title_justify="left", header_style="bold", box=None, pad_edge=False)
