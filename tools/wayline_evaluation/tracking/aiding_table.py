"""Predicted Dopplers as a table."""

from rich.table import Table

from wayline_evaluation.drive_table import drive_table, number, percent
from wayline_evaluation.tracking.aiding_study import AidingReport

COLUMNS = (
    "satellites",
    "rms\nHz",
    "p95\nHz",
    "std\nHz",
    "in 2 std\n%",
    "without\nvelocity, Hz",
)


def aiding_table(report: AidingReport) -> Table:
    """Two rows a drive: with GPS, and in the outages."""
    title = (
        f"Dopplers told by aiding against the truth, satellites in line of sight; "
        f"outages of {report.length_s:g} s every {report.every_s:g} s"
    )
    table = drive_table(title, COLUMNS, ("drive", "while"))
    for drive in report.drives:
        for name, found in (("GPS", drive.with_gps), ("outages", drive.in_outages)):
            if found is not None:
                table.add_row(
                    drive.drive,
                    name,
                    f"{found.count:,}",
                    number(found.rms_hz, 2),
                    number(found.p95_hz, 2),
                    number(found.std_hz, 2),
                    percent(found.in_two_std),
                    number(found.still_rms_hz),
                )
    return table
