"""`wayline simulate network`: what is asked for on the command line."""

import datetime as dt
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from wayline.strict import fitted
from wayline_simulator.folders import check_empty

if TYPE_CHECKING:
    from wayline_simulator.network.files import WrittenDay


def network_command(  # noqa: PLR0917 -- Typer makes options of them
    out: Annotated[Path, typer.Option(help="Folder for the feed and the drives.")],
    vehicles: Annotated[int, typer.Option(help="Buses, each with a block a day.")] = 4,
    days: Annotated[int, typer.Option(help="Days of service, from a Monday on.")] = 1,
    every: Annotated[float, typer.Option(help="Seconds between two reports.")] = 30.0,
    hours: Annotated[float, typer.Option(help="Of service a day, from six o'clock on.")] = 6.0,
    headway: Annotated[int, typer.Option(help="Minutes between two trips of a line.")] = 15,
    start: Annotated[
        dt.datetime, typer.Option(formats=["%Y-%m-%d"], help="The first day.")
    ] = dt.datetime(2026, 5, 4),
    assigned: Annotated[bool, typer.Option("--assigned", help="Reports name the block.")] = False,
    seed: Annotated[int, typer.Option(help="Another seed, another network.")] = 1,
    force: Annotated[bool, typer.Option("--force", help="Write into a folder with files.")] = False,
) -> None:
    """Make two lines that share a trunk, their GTFS feed, and days of buses that report seldom."""
    if not force:
        check_empty(out)
    from wayline_simulator.network.files import simulate_network  # noqa: PLC0415  -- slow to import
    from wayline_simulator.network.model import NetworkModel  # noqa: PLC0415

    asked = {
        "seed": seed,
        "vehicles": vehicles,
        "days": days,
        "every_s": every,
        "hours": hours,
        "headway_min": headway,
        "start": start.date(),
        "assigned": assigned,
    }
    simulate_network(fitted(asked, NetworkModel, "wayline simulate network"), out, _print_day)


def _print_day(day: "WrittenDay") -> None:
    typer.echo(f"{day.folder}: {day.trips} trips, {day.reports:,} reports")
