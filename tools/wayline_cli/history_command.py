"""`wayline history`: what a history database holds.

Each command imports what it needs when it runs, so that `--help` answers at once.
"""

import sys
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

history_app = typer.Typer(help="What happened: tracks and trips.", no_args_is_help=True)

DatabaseOption = Annotated[str, typer.Option(help="e.g. sqlite:///history.db")]
VehicleOption = Annotated[str | None, typer.Option(help="Its id; may be left out of one.")]
FromOption = Annotated[
    str | None, typer.Option("--from", help="From then on, e.g. 2026-11-22T08:00:00Z")
]
ToOption = Annotated[str | None, typer.Option("--to", help="Before then.")]


@history_app.command("list")
def history_list_command(database: DatabaseOption) -> None:
    """Say of which vehicles something is kept, from when to when."""
    from wayline_cli.history import list_vehicles

    list_vehicles(database, Console())


@history_app.command("trips")
def history_trips_command(
    database: DatabaseOption,
    vehicle: VehicleOption = None,
    from_: FromOption = None,
    to: ToOption = None,
    format_: Annotated[str, typer.Option("--format", help="table, csv or json")] = "table",
) -> None:
    """List the trips of a vehicle, or of all."""
    from wayline_cli.history import Asked, list_trips

    list_trips(database, Asked(vehicle, from_, to), format_, sys.stdout)


@history_app.command("export")
def history_export_command(
    database: DatabaseOption,
    vehicle: VehicleOption = None,
    from_: FromOption = None,
    to: ToOption = None,
    kind: Annotated[str, typer.Option(help="raw, fused or on_route")] = "fused",
    step_s: Annotated[float, typer.Option(help="One point in so many seconds.")] = 0.0,
    format_: Annotated[str, typer.Option("--format", help="gpx, csv, geojson or json")] = "gpx",
    out: Annotated[Path | None, typer.Option(help="File to write; default: stdout.")] = None,
) -> None:
    """Write where a vehicle was."""
    from wayline_cli.history import Asked, export_track
    from wayline_cli.output_file import binary_output

    asked = Asked(vehicle, from_, to, kind, step_s)
    size = export_track(database, asked, format_, lambda: binary_output(out))
    if out is not None:
        typer.echo(f"{out}: {size:,} bytes")
