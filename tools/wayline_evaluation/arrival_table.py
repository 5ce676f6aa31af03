"""Pure: how well eta follows and predicts, as a table."""

from rich.table import Table

from wayline_evaluation.arrivals import ArrivalReport

COLUMNS = (
    "on a trip\ns",
    "along p50\nm",
    "p95\nm",
    "told\n%",
    "stale\n%",
    "stops",
    "events",
    "event p50\ns",
    "p95\ns",
    "in bounds, 0-3 3-6\n6-10 10-15 min, %",
    "p10-p90\n%",
    "ghosts\n%",
)


def arrival_table(report: ArrivalReport) -> Table:
    """One row a drive, and one for all."""
    table = Table(
        title="what eta tells, against what the vehicle did",
        title_justify="left",
        header_style="bold",
        box=None,
        pad_edge=False,
    )
    table.add_column("drive")
    for name in COLUMNS:
        table.add_column(name, justify="right", no_wrap=True)
    for one in (*report.scores, report.pooled):
        table.add_row(
            one.drive,
            f"{one.seconds:,}",
            _number(one.along_p50_m),
            _number(one.along_p95_m),
            _percent(one.told_share),
            _percent(one.stale_share),
            f"{one.visits:,}",
            f"{one.events:,}",
            _number(one.event_p50_s),
            _number(one.event_p95_s),
            " ".join(_percent(share, 0) for share in one.benchmark_shares),
            _percent(one.within_share),
            _percent(one.ghost_share),
        )
    return table


def _number(value: float | None) -> str:
    return "" if value is None else f"{value:.1f}"


def _percent(share: float | None, digits: int = 1) -> str:
    return "" if share is None else f"{100.0 * share:.{digits}f}"
