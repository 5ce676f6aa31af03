"""The `wayline` command: parses arguments, shows progress, turns errors into one line."""

import signal
import sys
from pathlib import Path
from types import FrameType
from typing import Annotated

import typer
from rich.console import Console
from rich.progress import Progress, SpinnerColumn, TextColumn, TimeElapsedColumn
from rich.table import Table

from wayline import __version__
from wayline.errors import InputError
from wayline.route import write_route
from wayline_cli.replay import Summary, replay
from wayline_cli.route_import import route_from_csv
from wayline_cli.stream import Outage

app = typer.Typer(
    help="Locates vehicles, predicts their arrivals and learns the slope of the roads they drive.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)
route_app = typer.Typer(help="Routes for the arrivals service.", no_args_is_help=True)
app.add_typer(route_app, name="route")


def main() -> None:
    """Run the command; bad input is one line and status 2, Ctrl-C and SIGTERM end with 0."""
    signal.signal(signal.SIGTERM, _interrupt)
    try:
        app(standalone_mode=True)
    except InputError as error:
        sys.stderr.write(f"wayline: {error}\n")
        sys.exit(2)
    except KeyboardInterrupt:
        sys.exit(0)


def _interrupt(number: int, frame: FrameType | None) -> None:
    del number, frame
    raise KeyboardInterrupt


def _show_version(wanted: bool) -> None:
    if wanted:
        typer.echo(__version__)
        raise typer.Exit


@app.callback()
def _options(
    version: Annotated[
        bool, typer.Option("--version", callback=_show_version, is_eager=True, help="Print it.")
    ] = False,
) -> None:
    del version


@app.command("replay")
def replay_command(
    drive: Annotated[Path, typer.Argument(help="A drive's folder (with drive.toml).")],
    out: Annotated[Path, typer.Option(help="Folder for <topic>.jsonl, made if missing.")],
    gps_outage: Annotated[
        list[str] | None,
        typer.Option(
            metavar="START_S:LENGTH_S",
            help="Take GPS away for a while, counted from the drive's start; may be repeated.",
        ),
    ] = None,
    database: Annotated[
        str | None, typer.Option(help="Keep what is learned there, e.g. sqlite:///wayline.db")
    ] = None,
    route: Annotated[
        Path | None, typer.Option(help="Route to follow (GeoJSON), instead of the drive's own.")
    ] = None,
) -> None:
    """Run a recorded drive through the whole system, as fast as it goes."""
    outages = [parse_outage(text) for text in gps_outage or []]
    columns = (SpinnerColumn(), TextColumn("{task.description}"), TimeElapsedColumn())
    console = Console(stderr=True)
    hidden = not console.is_terminal
    with Progress(*columns, console=console, transient=True, disable=hidden) as bar:
        task = bar.add_task("opening the drive")

        def progressed(duration_s: float) -> None:
            elapsed_s = bar.tasks[0].elapsed or 0.0
            speed = duration_s / elapsed_s if elapsed_s > 0.0 else 0.0
            bar.update(task, description=f"{duration_s:,.0f} s driven, {speed:.0f} x real time")

        summary = replay(
            drive,
            out,
            outages=outages,
            database_url=database,
            route_path=route,
            progressed=progressed,
        )
    _print_summary(summary, out)


@route_app.command("import")
def route_import_command(
    csv: Annotated[Path, typer.Argument(help="CSV with latitude, longitude and speed columns.")],
    out: Annotated[Path, typer.Option(help="GeoJSON file to write.")],
    route_id: Annotated[str | None, typer.Option(help="Default: the file's name.")] = None,
    name: Annotated[str | None, typer.Option(help="Default: the route's id.")] = None,
    loop: Annotated[bool, typer.Option(help="Close the line; laps are counted.")] = False,
) -> None:
    """Make a route from a table of points; the speed of a point holds until the next one."""
    route = route_from_csv(csv, route_id or csv.stem, name or route_id or csv.stem, loop=loop)
    write_route(route, out)
    typer.echo(f"{out}: {route.route_id}, {route.length_m:,.0f} m, {route.duration_s:,.0f} s")


def parse_outage(text: str) -> Outage:
    """An outage from START_S:LENGTH_S."""
    start, colon, length = text.partition(":")
    try:
        outage = Outage(float(start), float(length))
    except ValueError:
        colon = ""
    if not colon or outage.start_s < 0.0 or outage.length_s <= 0.0:
        mend = "give START_S:LENGTH_S, e.g. 600:60"
        raise InputError("--gps-outage", f"{text!r} is no outage", mend)
    return outage


def _print_summary(summary: Summary, out: Path) -> None:
    table = Table(title=f"{summary.vehicle_id}: replayed to {out}", show_header=False)
    table.add_column(style="bold")
    table.add_column(justify="right")
    table.add_row("duration", f"{summary.duration_s:,.1f} s")
    table.add_row("distance", f"{summary.distance_m / 1000.0:,.3f} km")
    table.add_row("real-time factor", f"{summary.real_time_factor:,.0f}")
    for topic, count in summary.counts.items():
        table.add_row(topic, f"{count:,}")
    for source, count in summary.bad_input.items():
        table.add_row(f"bad input, {source}", f"{count:,}")
    Console().print(table)


if __name__ == "__main__":
    main()
