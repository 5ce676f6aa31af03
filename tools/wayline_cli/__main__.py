"""The `wayline` command: parses arguments, shows progress, turns errors into one line.

Each command imports what it needs when it runs, so that `--help` answers at once.
"""

import os
import signal
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from types import FrameType
from typing import TYPE_CHECKING, Annotated

import typer
from rich.console import Console
from rich.progress import Progress, SpinnerColumn, TextColumn, TimeElapsedColumn
from rich.table import Table

from wayline import __version__
from wayline.errors import InputError
from wayline_cli.doctor_command import doctor_app
from wayline_cli.history_command import history_app
from wayline_cli.slope_command import slope_app
from wayline_evaluation.commands import evaluate_app
from wayline_simulator.command import simulate_app

if TYPE_CHECKING:
    from wayline.settings import BusSettings, Settings
    from wayline_replay.replay import Summary

app = typer.Typer(
    help="Locates vehicles, predicts their arrivals and learns the slope of the roads they drive.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)
route_app = typer.Typer(help="Routes for the arrivals service.", no_args_is_help=True)
timetable_app = typer.Typer(help="Timetables: GTFS feeds.", no_args_is_help=True)
app.add_typer(route_app, name="route")
app.add_typer(timetable_app, name="timetable")
app.add_typer(evaluate_app, name="evaluate")
app.add_typer(simulate_app, name="simulate")
app.add_typer(slope_app, name="slope")
app.add_typer(history_app, name="history")
app.add_typer(doctor_app, name="doctor")

ConfigOption = Annotated[Path, typer.Option(help="Configuration file (see deploy/wayline.toml).")]
OptionalConfig = Annotated[
    Path | None, typer.Option(help="Configuration file; default: the defaults on this machine.")
]


def main() -> None:
    """Run the command; bad input is one line and status 2, Ctrl-C and SIGTERM end with 0."""
    signal.signal(signal.SIGTERM, _interrupt)
    try:
        app(standalone_mode=True)
    except InputError as error:
        sys.stderr.write(f"wayline: {error}\n")
        sys.exit(2)
    except BrokenPipeError:
        # whoever read the output has seen enough; nothing may be flushed into the closed pipe
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        sys.exit(0)
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


@app.command("demo")
def demo_command(
    keep: Annotated[
        Path | None, typer.Option(help="Folder for its files, kept; default: a temporary one.")
    ] = None,
    first_port: Annotated[
        int | None, typer.Option(help="Use ports from here on instead of 8000-8007 and 7447.")
    ] = None,
    no_open: Annotated[bool, typer.Option("--no-open", help="Do not open the page.")] = False,
    seconds: Annotated[float | None, typer.Option(help="End after so many seconds.")] = None,
) -> None:
    """Run the whole system live on this machine, with a shuttle and a truck; Ctrl-C ends it."""
    from wayline_cli.demo import demo

    demo(
        keep=keep,
        first_port=first_port,
        open_page=not no_open,
        seconds=seconds,
        say=typer.echo,
    )


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
        list[Path] | None,
        typer.Option(
            help="Route to follow (GeoJSON), instead of the drive's own; may be repeated."
        ),
    ] = None,
    feed: Annotated[
        list[Path] | None,
        typer.Option(help="Timetable with the trip to follow (GTFS); may be repeated."),
    ] = None,
) -> None:
    """Run a recorded drive through the whole system, as fast as it goes."""
    from wayline_replay.outages import parse_outage
    from wayline_replay.replay import replay
    from wayline_replay.stream import check_outages_of

    outages = [parse_outage(text) for text in gps_outage or []]
    check_outages_of(drive, outages)
    with _progress() as progressed:
        summary = replay(
            drive,
            out,
            outages=outages,
            database_url=database,
            route_paths=route or (),
            feed_paths=feed or (),
            progressed=progressed,
        )
    _print_summary(summary, out)


@app.command("split")
def split_command(
    table: Annotated[Path, typer.Argument(help="A table of position reports, CSV.")],
    by: Annotated[str, typer.Option(help="The column that tells the drives apart.")],
    template: Annotated[
        Path, typer.Option(help="A drive.toml with $table, $value and $id where these belong.")
    ],
    out: Annotated[Path, typer.Option(help="Folder for the drives' folders.")],
) -> None:
    """Make a drive's folder of each value in a column of one table."""
    from wayline_cli.split_table import split_table

    folders = split_table(table, by, template, out)
    typer.echo(f"{len(folders):,} drives in {out}")


@app.command("view")
def view_command(
    source: Annotated[Path, typer.Argument(help="A drive, a replay's output or an MCAP file.")],
    save: Annotated[
        Path | None, typer.Option(help="Write an .rrd file instead of opening the viewer.")
    ] = None,
    route: Annotated[
        Path | None, typer.Option(help="Route to draw (GeoJSON), instead of the drive's own.")
    ] = None,
) -> None:
    """Show a drive in Rerun: map, innovations against gates, calibration, altitude, states."""
    from wayline_cli.view import view

    with _progress() as progressed:
        viewed = view(source, save, route_path=route, progressed=progressed)
    if save is not None:
        typer.echo(f"{viewed.path}: {viewed.rows:,} rows in {viewed.elapsed_s:.1f} s")


@app.command("up")
def up_command(config: ConfigOption) -> None:
    """Start, watch and restart the services that a configuration lists, until told to stop."""
    from wayline_cli.up import up

    up(config)


@app.command("record")
def record_command(
    file: Annotated[Path, typer.Argument(help="MCAP file to write.")],
    config: OptionalConfig = None,
    seconds: Annotated[float | None, typer.Option(help="Stop after so many seconds.")] = None,
    force: Annotated[bool, typer.Option("--force", help="Overwrite the file.")] = False,
    from_: Annotated[
        str | None, typer.Option("--from", help="Not of the bus: of the past, from then on.")
    ] = None,
    to: Annotated[str | None, typer.Option("--to", help="Of the past, before then.")] = None,
    database: Annotated[
        str | None, typer.Option(help="Where history keeps the past; default: database_url.")
    ] = None,
    vehicle: Annotated[str | None, typer.Option(help="Of the past: one vehicle.")] = None,
) -> None:
    """Record every message of the bus to an MCAP file, until told to stop; or what history kept."""
    from wayline_cli.record import record

    if from_ is not None or to is not None:
        _record_past(file, _history_url(config, database), (vehicle, from_, to), force=force)
        return

    recorded = record(file, _bus(config), seconds=seconds, force=force, say=_say)
    for topic, count in recorded.counts.items():
        typer.echo(f"{topic:14} {count:>10,}")
    lost = recorded.dropped + recorded.missed + recorded.refused
    typer.echo(f"{'lost':14} {lost:>10,}")


def _record_past(
    file: Path, database: str, asked: tuple[str | None, str | None, str | None], *, force: bool
) -> None:
    from wayline_cli.history import Asked
    from wayline_cli.record_past import record_past

    for topic, count in record_past(file, database, Asked(*asked), force=force).items():
        typer.echo(f"{topic:14} {count:>10,}")


def _history_url(config: Path | None, database: str | None) -> str:
    url = database or _settings(config).database_url
    if url is None:
        mend = "give --database, e.g. sqlite:///history.db, or a --config that names one"
        raise InputError("--database", "is missing, the past is in there", mend)
    return url


@app.command("play")
def play_command(
    file: Annotated[Path, typer.Argument(help="MCAP file of `wayline record`.")],
    config: OptionalConfig = None,
    speed: Annotated[float, typer.Option(help="Times as fast as recorded.")] = 1.0,
) -> None:
    """Play a recording back onto the bus, under the keys that it was recorded from."""
    from wayline_cli.play import play

    played = play(file, _bus(config), speed=speed, say=_say)
    typer.echo(f"{played.messages:,} messages, {played.seconds:,.1f} s")
    if not played.complete:
        _say(f"{file} ends abruptly: its recorder was killed")


@route_app.command("import")
def route_import_command(
    source: Annotated[
        Path, typer.Argument(help="CSV of points, GPX, GeoJSON; or a GTFS folder or zip.")
    ],
    *,
    out: Annotated[
        Path, typer.Option(help="GeoJSON file to write; a folder: one file a pattern of a feed.")
    ],
    route_id: Annotated[
        str | None, typer.Option(help="Of a line; default: its own, else the file's name.")
    ] = None,
    name: Annotated[str | None, typer.Option(help="Of a line; default: its own.")] = None,
    loop: Annotated[
        bool | None, typer.Option(help="Of a line: close it, count laps; default: as it says.")
    ] = None,
    line: Annotated[
        str | None, typer.Option(help="Id, name or number of one of several lines.")
    ] = None,
    trip: Annotated[str | None, typer.Option(help="Of a GTFS feed: the trip to follow.")] = None,
) -> None:
    """Make a route; the speed of a CSV's point holds until the next one."""
    from wayline.timetable.notes import Notes
    from wayline_cli.route_import import Wishes, import_patterns, import_route, is_feed
    from wayline_cli.route_writing import is_folder, write_routes

    notes = Notes()
    if trip is None and is_folder(out) and is_feed(source):
        routes = import_patterns(source, notes)
    else:
        routes = [import_route(source, Wishes(route_id, name, loop, line, trip), notes)]
    for note in notes.all():
        typer.echo(f"warning: {note}", err=True)
    for path, route in write_routes(routes, out):
        planned_s = route.duration_s + float(route.stop_dwells_s[:-1].sum())
        typer.echo(f"{path}: {route.route_id}, {route.length_m:,.0f} m, {planned_s:,.0f} s")


@timetable_app.command("check")
def timetable_check_command(
    feed: Annotated[Path, typer.Argument(help="GTFS folder or zip.")],
) -> None:
    """Say what a feed holds, what was mended, and what cannot be used."""
    import datetime as dt

    from wayline_cli.timetable_check import check_timetable

    check_timetable(feed, dt.datetime.now(dt.UTC).date(), Console())


def _bus(config: Path | None) -> "BusSettings":
    return _settings(config).bus


def _settings(config: Path | None) -> "Settings":
    from wayline.settings import Settings, load_settings, overridden

    return load_settings(config) if config else overridden(Settings(), os.environ)


def _say(text: str) -> None:
    typer.echo(f"wayline: {text}", err=True)


@contextmanager
def _progress() -> Iterator[Callable[[float], None]]:
    """How far a replay has come, on a terminal."""
    console = Console(stderr=True)
    columns = (SpinnerColumn(), TextColumn("{task.description}"), TimeElapsedColumn())
    hidden = not console.is_terminal
    with Progress(*columns, console=console, transient=True, disable=hidden) as bar:
        task = bar.add_task("opening the drive")

        def progressed(duration_s: float) -> None:
            elapsed_s = bar.tasks[0].elapsed or 0.0
            speed = duration_s / elapsed_s if elapsed_s > 0.0 else 0.0
            bar.update(task, description=f"{duration_s:,.0f} s driven, {speed:.0f} x real time")

        yield progressed


def _print_summary(summary: "Summary", out: Path) -> None:
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
    for source, reasons in summary.left_out.items():
        for reason, count in reasons.items():
            table.add_row(f"left out, {source}: {reason}", f"{count:,}")
    Console().print(table)
    for warning in summary.warnings:
        typer.echo(f"warning: {warning}")


if __name__ == "__main__":
    main()
