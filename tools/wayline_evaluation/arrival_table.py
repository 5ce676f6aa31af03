"""Pure: how well eta follows and predicts, as a table."""

from rich.table import Table

from wayline_evaluation.arrivals import ArrivalReport
from wayline_evaluation.drive_table import drive_table, number, percent

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
    table = drive_table("what eta tells, against what the vehicle did", COLUMNS)
    for one in (*report.scores, report.pooled):
        table.add_row(
            one.drive,
            f"{one.seconds:,}",
            number(one.along_p50_m),
            number(one.along_p95_m),
            percent(one.told_share),
            percent(one.stale_share),
            f"{one.visits:,}",
            f"{one.events:,}",
            number(one.event_p50_s),
            number(one.event_p95_s),
            " ".join(percent(share, 0) for share in one.benchmark_shares),
            percent(one.within_share),
            percent(one.ghost_share),
        )
    return table
