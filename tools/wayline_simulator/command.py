"""`wayline simulate`: what is asked for on the command line over what a scenario file says."""

import time
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.console import Console
from rich.table import Table

from wayline.errors import InputError
from wayline_simulator.folders import check_empty
from wayline_simulator.network.command import network_command
from wayline_simulator.trips.command import trips_command

if TYPE_CHECKING:
    from wayline_simulator.drive_folder import Written
    from wayline_simulator.scenario import Scenario

simulate_app = typer.Typer()
ROAD_FILES = (".geojson", ".json", ".gpx", ".csv")


@simulate_app.callback(invoke_without_command=True)
def simulate_command(  # noqa: PLR0917 -- Typer makes options of them
    context: typer.Context,
    out: Annotated[
        Path | None, typer.Option(help="Folder for the drive; several runs get folders in it.")
    ] = None,
    scenario: Annotated[
        str | None, typer.Option(help="One of --list, or a TOML file; the options below go before.")
    ] = None,
    preset: Annotated[
        str | None, typer.Option(help="Sensors: consumer, mems, cheap, thesis, css.")
    ] = None,
    road: Annotated[
        str | None,
        typer.Option(
            help="motorway, main, urban, hills, eight, garage; a GeoJSON or GPX line; "
            "an earlier drive's folder."
        ),
    ] = None,
    length_m: Annotated[float | None, typer.Option(help="Of the road, or of one lap.")] = None,
    laps: Annotated[int | None, typer.Option(help="How often a loop is driven.")] = None,
    vehicle: Annotated[str | None, typer.Option(help="car, truck, bus.")] = None,
    vehicle_id: Annotated[str | None, typer.Option(help="Name on the bus.")] = None,
    runs: Annotated[int | None, typer.Option(help="Drives over the same road.")] = None,
    raw: Annotated[
        bool, typer.Option("--raw", help="The receiver also tells what it measured of satellites.")
    ] = False,
    seed: Annotated[int | None, typer.Option(help="Another seed, another drive.")] = None,
    list_: Annotated[bool, typer.Option("--list", help="Name the scenarios and end.")] = False,
    force: Annotated[bool, typer.Option("--force", help="Write into a folder with files.")] = False,
) -> None:
    """Make drives with known truth: NMEA and CAN files as devices would write them."""
    if context.invoked_subcommand is not None:
        return
    if list_:
        _print_scenarios()
        return
    if out is None:
        raise InputError("--out", "no folder to write the drive to", "give --out FOLDER")
    if not force:
        check_empty(out)
    from wayline_simulator.drive_folder import simulate  # noqa: PLC0415  -- slow to import

    wanted, beside = _scenario(scenario)
    asked: dict[str, object] = {
        "preset": preset,
        "vehicle": vehicle,
        "vehicle_id": vehicle_id,
        "runs": runs,
        "seed": seed,
    }
    if raw and wanted.raw is None:
        asked["raw"] = {}
    wanted = _overridden(wanted, asked, _road_asked(road, length_m, laps))
    started = time.perf_counter()
    drives = simulate(wanted, out, beside=beside, written=_print_drive)
    elapsed_s = time.perf_counter() - started
    driven_s = sum(drive.duration_s for drive in drives)
    typer.echo(f"{driven_s:,.0f} s driven, {driven_s / elapsed_s:,.0f} times faster than real time")


simulate_app.command("network")(network_command)
simulate_app.command("trips")(trips_command)


def _scenario(name: str | None) -> "tuple[Scenario, Path]":
    """The scenario and the folder from which its road's file is looked for."""
    from wayline_simulator.scenario import Scenario  # noqa: PLC0415
    from wayline_simulator.scenario_file import load_scenario  # noqa: PLC0415

    if name is None:
        return Scenario(), Path()
    return load_scenario(name), Path(name).parent


def _road_asked(road: str | None, length_m: float | None, laps: int | None) -> dict[str, object]:
    asked: dict[str, object] = {"length_m": length_m, "laps": laps}
    if road is not None:
        path = Path(road)
        is_file = path.suffix in ROAD_FILES or path.exists()
        asked |= {"kind": "file", "path": str(path.absolute())} if is_file else {"kind": road}
    return asked


def _overridden(
    scenario: "Scenario", asked: dict[str, object], road: dict[str, object]
) -> "Scenario":
    from wayline_simulator.scenario import overlaid  # noqa: PLC0415

    given = {key: value for key, value in asked.items() if value is not None}
    of_road = {key: value for key, value in road.items() if value is not None}
    return overlaid(scenario, given | ({"road": of_road} if of_road else {}))


def _print_drive(drive: "Written") -> None:
    typer.echo(f"{drive.folder}: {drive.duration_s:,.0f} s, {drive.distance_m / 1000.0:,.2f} km")


def _print_scenarios() -> None:
    from wayline_simulator.scenario_file import shipped_scenarios  # noqa: PLC0415

    table = Table("scenario", "", box=None, header_style="bold", pad_edge=False)
    for name, description in shipped_scenarios().items():
        table.add_row(name, description)
    Console().print(table)
