"""Pure: trips that were found, as a table."""

from rich.table import Table

from wayline_evaluation.drive_table import drive_table, percent
from wayline_evaluation.trips import TripReport

COLUMNS = (
    "every\ns",
    "on a trip\ns",
    "told\n%",
    "right\n%",
    "alone\n%",
    "driven\n%",
    "later\n%",
    "wrong way\nfixes",
    "idle\n%",
)


def trip_table(report: TripReport) -> Table:
    """One row a drive, and one for all."""
    table = drive_table("the trip that was told, against the one that was run", COLUMNS)
    for score in (*report.scores, report.pooled):
        table.add_row(
            score.drive,
            f"{score.every_s:.0f}",
            f"{score.seconds:,}",
            *map(
                percent,
                (
                    score.told_share,
                    score.right_share,
                    score.alone_share,
                    score.alone_driven_share,
                    score.later_share,
                ),
            ),
            str(score.wrong_way_reports),
            percent(score.idle_share),
        )
    return table
