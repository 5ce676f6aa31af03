"""Pure: fixes that come seldom, as a table."""

from rich.table import Table

from wayline_evaluation.figures import Figures
from wayline_evaluation.sparse import SparseReport

FIGURES = ("at a fix", "before next", "straight on")


def sparse_table(report: SparseReport) -> Table:
    """One row a drive and interval; distances at p50 and p95."""
    table = Table(
        title="fixes that come seldom: p50 / p95, m",
        title_justify="left",
        header_style="bold",
        box=None,
        pad_edge=False,
    )
    table.add_column("drive")
    table.add_column("against")
    for name in ("every\ns", "fixes", "accepted\n%", "lost\n%", *FIGURES, "in 2 sigma\n%"):
        table.add_column(name, justify="right", no_wrap=True)
    for score in report.scores:
        inside = score.between
        table.add_row(
            score.drive,
            score.reference,
            f"{score.every_s:g}",
            str(score.fixes),
            _percent(score.accepted_share),
            _percent(score.lost_share),
            *map(_pair, (score.at_fix_m, score.before_next_m, score.straight_on_m)),
            _percent(None if inside is None else inside.two_sigma),
        )
    return table


def _percent(share: float | None) -> str:
    return "" if share is None else f"{100.0 * share:.1f}"


def _pair(figures: Figures | None) -> str:
    return "" if figures is None else f"{figures.p50:.1f} / {figures.p95:.1f}"
