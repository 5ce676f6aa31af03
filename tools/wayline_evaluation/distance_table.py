"""Pure: distances of trips as a table."""

from collections.abc import Iterator

from rich.table import Table

from wayline.trip_distance.wording import DIGITS_MAX, KM_M, in_km
from wayline_evaluation.distances import DistanceReport, Measured
from wayline_evaluation.drive_table import drive_table, number, percent

COLUMNS = ("km", "bridged\nkm", "GPS alone\nkm", "reference\nkm", "off\n%", "stds")


def distance_tables(report: DistanceReport) -> Iterator[Table]:
    """A row a drive, then all of them, then what is to be doubted."""
    table = drive_table("distance of trips, one sigma", COLUMNS, ("drive", "by", "reference"))
    for each in report.drives:
        reference_km = each.reference_m and each.reference_m / KM_M
        table.add_row(
            each.drive,
            each.measured.basis,
            each.reference or "",
            _in_km(each.measured),
            number(each.measured.bridged_m / KM_M, 2),
            "" if each.by_gps is None else _in_km(each.by_gps),
            number(reference_km, DIGITS_MAX),
            number(each.error_pct, 2),
            number(each.stds, 1),
        )
    yield table
    if len(report.drives) > 1 and report.error_p50_pct is not None:
        yield _all(report)
    notes = drive_table("noticed", ("",), ("drive",))
    for each in report.drives:
        for note in each.notes:
            notes.add_row(each.drive, note)
    if notes.row_count:
        yield notes


def _in_km(measured: Measured) -> str:
    return in_km(measured.distance_m, measured.distance_std_m)


def _all(report: DistanceReport) -> Table:
    columns = ("p50\n%", "mean\n%", "p95\n%", "max\n%", "in 2 stds\n%")
    table = drive_table("GPS alone against the reference", columns, ("drives",))
    shares = report.error_p50_pct, report.error_mean_pct, report.error_p95_pct, report.error_max_pct
    table.add_row(
        str(len(report.drives)), *(number(share, 2) for share in shares), percent(report.in_two_std)
    )
    return table
