"""`wayline slope`: what a slope database knows, and of which runs.

Each command imports what it needs when it runs, so that `--help` answers at once.
"""

import sys
from pathlib import Path
from typing import Annotated

import typer

from wayline.errors import InputError

slope_app = typer.Typer(help="Slope databases.", no_args_is_help=True)


@slope_app.command("export")
def slope_export_command(
    database: Annotated[str, typer.Option(help="e.g. sqlite:///wayline.db")],
    format_: Annotated[str, typer.Option("--format", help="csv")] = "csv",
    out: Annotated[Path | None, typer.Option(help="File to write; default: stdout.")] = None,
) -> None:
    """Write what a database knows of its roads, one row a bin."""
    from wayline_cli.slope_export import export_slope_csv

    if format_ != "csv":
        raise InputError("--format", f"{format_!r} is unknown", "give csv")
    rows = export_slope_csv(database, out, sys.stdout)
    if out is not None:
        typer.echo(f"{out}: {rows:,} bins")


@slope_app.command("list")
def slope_list_command(
    database: Annotated[str, typer.Option(help="e.g. sqlite:///wayline.db")],
    left_out: Annotated[
        bool, typer.Option("--left-out", help="Instead, what of the drives was left out, and why.")
    ] = False,
) -> None:
    """Name the runs that were merged, one a line, in order of time."""
    from wayline_cli.slope_runs import list_left_out, list_runs

    (list_left_out if left_out else list_runs)(database, sys.stdout)


@slope_app.command("withdraw")
def slope_withdraw_command(
    run: Annotated[str, typer.Argument(help="One of `wayline slope list`.")],
    database: Annotated[str, typer.Option(help="e.g. sqlite:///wayline.db")],
) -> None:
    """Take a run out of the map again, as if it had never been merged."""
    from wayline_cli.slope_runs import withdraw_run

    typer.echo(withdraw_run(database, run))
