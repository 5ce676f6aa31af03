"""Pure: the published route filter beside its printed estimates, as tables."""

from collections.abc import Iterator

from rich.table import Table

from wayline_evaluation.avl import AvlReport
from wayline_evaluation.drive_table import drive_table, number


def avl_tables(report: AvlReport) -> Iterator[Table]:
    """Distances from what is printed, then the ellipses by how old the last fix is."""
    title = f"the published filter beside {report.rows} printed estimates (papers/000, appendix D)"
    table = drive_table(title, ("mean\nm", "rms\nm", "max\nm"), ("axis",))
    for name, axis in (("north", report.north), ("east", report.east), ("flat", report.flat)):
        table.add_row(name, *(number(each, 2) for each in (axis.mean_m, axis.rms_m, axis.max_m)))
    yield table
    title = "ellipses of 1 sigma by rows without a fix (papers/000, figures 20 and 21)"
    columns = ("count", "long\nm", "short\nm", "off the route\ndeg")
    table = drive_table(title, columns, ("rows",))
    for gap in report.gaps:
        axes = number(gap.major_m, 2), number(gap.minor_m, 2), number(gap.off_route_deg)
        table.add_row(str(gap.rows_without), f"{gap.count:,}", *axes)
    yield table
