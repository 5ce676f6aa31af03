"""Pure: how good arrivals were, as a table."""

from rich.table import Table

from wayline_evaluation.eta import EtaReport, EtaScore, SpanScore

COLUMNS = (
    "ahead\nmin",
    "count",
    "mean\ns",
    "absolute\ns",
    "std\ns",
    "Benchmark\n%",
    "Cal-ITP\n%",
    "p10-p90\nholds %",
)


def eta_table(report: EtaReport) -> Table:
    """A row a drive and span of minutes ahead, then all drives together."""
    table = Table(
        title="arrivals: when the vehicle came minus when it was said to",
        title_justify="left",
        header_style="bold",
        box=None,
        pad_edge=False,
    )
    table.add_column("drive")
    for name in COLUMNS:
        table.add_column(name, justify="right", no_wrap=True)
    for score in (*report.scores, report.pooled):
        for span in score.spans:
            if span.count:
                table.add_row(score.drive, *_cells(span))
        table.add_row(score.drive, *_summary(score), end_section=True)
    return table


def _cells(span: SpanScore) -> tuple[str, ...]:
    return (
        f"{span.from_min:g}-{span.to_min:g}",
        f"{span.count:,}",
        _seconds(span.mean_s),
        _seconds(span.mean_absolute_s),
        _seconds(span.std_s),
        _percent(span.benchmark_share),
        _percent(span.cal_itp_share),
        _percent(span.held_share),
    )


def _summary(score: EtaScore) -> tuple[str, ...]:
    told = f"told {_percent(score.told_share)} %, ghosts {_percent(score.ghost_share)} %"
    return f"{score.arrivals:,} stops", told, "", "", "", _percent(score.benchmark_share), "", ""


def _seconds(seconds: float | None) -> str:
    return "" if seconds is None else f"{seconds:.0f}"


def _percent(share: float | None) -> str:
    return "" if share is None else f"{100.0 * share:.1f}"
