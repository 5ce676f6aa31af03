"""Pure: fixes that come seldom, as a table."""

from rich.table import Table

from wayline_evaluation.drive_table import drive_table, percent
from wayline_evaluation.figures import Figures
from wayline_evaluation.sparse import SparseReport

COLUMNS = (
    "every\ns",
    "fixes",
    "accepted\n%",
    "lost\n%",
    "at a fix",
    "before next",
    "straight on",
    "in 2 sigma\n%",
)


def sparse_table(report: SparseReport) -> Table:
    """One row a drive and interval; distances at p50 and p95."""
    table = drive_table("fixes that come seldom: p50 / p95, m", COLUMNS, ("drive", "against"))
    for score in report.scores:
        inside = score.between
        table.add_row(
            score.drive,
            score.reference,
            f"{score.every_s:g}",
            str(score.fixes),
            percent(score.accepted_share),
            percent(score.lost_share),
            *map(_pair, (score.at_fix_m, score.before_next_m, score.straight_on_m)),
            percent(None if inside is None else inside.two_sigma),
        )
    return table


def _pair(figures: Figures | None) -> str:
    return "" if figures is None else f"{figures.p50:.1f} / {figures.p95:.1f}"
