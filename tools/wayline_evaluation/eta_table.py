"""Pure: how good arrivals were, as a table."""

from rich.table import Table

from wayline_eta.scores import SpanScore
from wayline_evaluation.drive_table import drive_table, number, percent
from wayline_evaluation.eta import EtaReport, EtaScore

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
    table = drive_table("arrivals: when the vehicle came minus when it was said to", COLUMNS)
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
        number(span.mean_s, 0),
        number(span.mean_absolute_s, 0),
        number(span.std_s, 0),
        percent(span.benchmark_share),
        percent(span.cal_itp_share),
        percent(span.held_share),
    )


def _summary(score: EtaScore) -> tuple[str, ...]:
    told = f"told {percent(score.told_share)} %, ghosts {percent(score.ghost_share)} %"
    return f"{score.arrivals:,} stops", told, "", "", "", percent(score.benchmark_share), "", ""
