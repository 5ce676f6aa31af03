"""`wayline doctor` and `wayline doctor can`.

Each command imports what it needs when it runs, so that `--help` answers at once.
"""

from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.console import Console
from rich.markup import escape
from rich.table import Table

from wayline.errors import InputError

if TYPE_CHECKING:
    from wayline.live_sources import LiveCan
    from wayline_can_ingest.diagnosis.diagnose import Diagnosis
    from wayline_can_ingest.diagnosis.listen import Heard
    from wayline_can_ingest.mapping import Mapping

doctor_app = typer.Typer(invoke_without_command=True)
FILE_WIDTH = 120
"""Where no terminal sets a width, tables are not cut."""
SOCKETCAN, FIRST = "socketcan", "can0"
Scalar = str | int | float | bool


@doctor_app.callback()
def doctor_command(
    context: typer.Context,
    config: Annotated[
        Path | None, typer.Option(help="Configuration file; default: the defaults on this machine.")
    ] = None,
) -> None:
    """Check configuration, devices, ports, router and database, and say what to mend.

    `wayline doctor can` looks at one CAN bus, or at a recording of it.
    """
    if context.invoked_subcommand is not None:
        return
    from wayline_cli.check import is_well
    from wayline_cli.doctor import doctor

    checks = doctor(config)
    table = Table("", "", "found", "to mend", box=None, header_style="bold", pad_edge=False)
    marks = {"fine": "[green]ok[/]", "note": "[yellow]note[/]", "wrong": "[red]wrong[/]"}
    for check in checks:
        mark = marks[check.mark.value]
        table.add_row(mark, check.subject, escape(check.finding), escape(check.mend))
    Console().print(table)
    raise typer.Exit(0 if is_well(checks) else 1)


@doctor_app.command("can")
def doctor_can_command(
    *,
    interface: Annotated[
        str | None,
        typer.Option(help="python-can's name: socketcan, slcan, pcan, kvaser, vector ..."),
    ] = None,
    channel: Annotated[
        str | None, typer.Option(help="can0, /dev/ttyACM0, PCAN_USBBUS1 ...")
    ] = None,
    bitrate: Annotated[
        int | None, typer.Option(help="Bits per second, where the interface sets it.")
    ] = None,
    option: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME=VALUE", help="What else python-can's interface takes."),
    ] = None,
    seconds: Annotated[float, typer.Option(min=0.1, help="How long to listen.")] = 10.0,
    obd2: Annotated[
        bool, typer.Option("--obd2", help="Ask a car for its values; otherwise it only listens.")
    ] = False,
    log: Annotated[
        list[Path] | None,
        typer.Option(help="A recording in place of a bus (.log .asc .blf .mf4 ...); repeatable."),
    ] = None,
    dbc: Annotated[
        list[Path] | None, typer.Option(help="Database to propose a mapping from; repeatable.")
    ] = None,
) -> None:
    """Tell which profile fits a CAN bus or a recording of it, what arrives and what is missing.

    Without --log the bus is --interface (socketcan) and --channel (can0).

    With --dbc a mapping is proposed by names, units and ranges; with --dbc alone without ranges.

    Nothing is sent, unless --obd2 is given.

    wayline doctor can --channel can0 --seconds 20

    wayline doctor can --channel can0 --obd2

    wayline doctor can --log drive.log --dbc car.dbc
    """
    from wayline_can_ingest.dbc import load_databases
    from wayline_can_ingest.diagnosis import table as can_table
    from wayline_can_ingest.diagnosis.diagnose import diagnose
    from wayline_can_ingest.diagnosis.listen import Heard, heard_in

    # absolute, so that a table pasted elsewhere finds them
    logs, paths = ([path.absolute() for path in given or ()] for given in (log, dbc))
    live_options = (interface, channel, bitrate, option, obd2 or None)
    asks_live = any(each is not None for each in live_options)
    if logs and asks_live:
        mend = "give --log alone, or a bus without it"
        raise InputError("--log", "is a recording; --interface and its like are of a bus", mend)
    databases = load_databases(paths)
    if logs:
        heard, source = heard_in(logs), can_table.recorded(logs)
    elif paths and not asks_live:
        heard, source = Heard(()), can_table.live(_source(None, None, None, None, obd2=False))
    else:
        live = _source(interface, channel, bitrate, option, obd2=obd2)
        heard, source = _listened(live, seconds), can_table.live(live)
    _echo(filter(None, (heard.note, heard.mend)))
    if heard.frames or not heard.mend:
        _show(diagnose(heard.frames, _profiles(), databases, paths, source))
    raise typer.Exit(1 if heard.mend else 0)


def _source(
    interface: str | None,
    channel: str | None,
    bitrate: int | None,
    option: list[str] | None,
    *,
    obd2: bool,
) -> "LiveCan":
    from wayline.live_sources import LiveCan
    from wayline.strict import fitted

    tables = {
        "interface": interface or SOCKETCAN,
        "channel": channel or FIRST,
        "bitrate": bitrate,
        "options": dict(_option(text) for text in option or ()),
        "obd2": obd2 or None,
    }
    return fitted(tables, LiveCan, "command line")


def _option(text: str) -> tuple[str, Scalar]:
    """NAME=VALUE, the value as TOML has it, else as text."""
    import tomllib

    name, found, value = text.partition("=")
    if not (found and name):
        raise InputError("--option", f"{text!r} is no option", "give NAME=VALUE, e.g. port=43113")
    try:
        parsed = tomllib.loads(f"value = {value}")["value"]
    except tomllib.TOMLDecodeError:
        return name, value
    return name, parsed if isinstance(parsed, str | int | float) else value


def _listened(source: "LiveCan", seconds: float) -> "Heard":
    from wayline_can_ingest.diagnosis.listen import heard_on

    what = "polling" if source.obd2 else "listening to"
    typer.echo(f"{what} {source.interface} {source.channel} for {seconds:g} s", err=True)
    return heard_on(source, seconds)


def _profiles() -> dict[str, "Mapping"]:
    """Every profile there is, compiled."""
    from wayline.drive import CanMapping, Vehicle
    from wayline.profile import profile_names
    from wayline_can_ingest.configured import load_mapping

    return {
        name: load_mapping(CanMapping(), Vehicle(profile=name, engine_reference_torque_nm=1.0), "")
        for name in profile_names()
    }


def _show(diagnosis: "Diagnosis") -> None:
    from wayline_cli import can_report

    _echo(can_report.summary(diagnosis))
    table = can_report.quantities(diagnosis)
    if table.row_count:
        console = Console()
        typer.echo()
        (console if console.is_terminal else Console(width=FILE_WIDTH)).print(table)
        typer.echo()
    _echo(can_report.shortcomings(diagnosis))
    typer.echo()
    _echo(can_report.tables(diagnosis))


def _echo(lines: "Iterable[str]") -> None:
    for line in lines:
        typer.echo(line)
