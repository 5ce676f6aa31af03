"""Pure: tables with a row a drive, and how their figures are written."""

from collections.abc import Sequence

from rich.table import Table


def drive_table(title: str, columns: Sequence[str], names: Sequence[str] = ("drive",)) -> Table:
    """An empty table: names to the left, figures to the right."""
    table = Table(title=title, title_justify="left", header_style="bold", box=None, pad_edge=False)
    for name in names:
        table.add_column(name)
    for name in columns:
        table.add_column(name, justify="right", no_wrap=True)
    return table


def number(value: float | None, digits: int = 1) -> str:
    """Empty where there is none."""
    return "" if value is None else f"{value:.{digits}f}"


def percent(share: float | None, digits: int = 1) -> str:
    """A share in hundredths; empty where there is none."""
    return number(None if share is None else 100.0 * share, digits)
