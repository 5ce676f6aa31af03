"""`wayline simulate trips`: what is asked for on the command line."""

import datetime as dt
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from wayline.strict import fitted
from wayline_simulator.folders import check_empty

if TYPE_CHECKING:
    from wayline_simulator.trips.files import WrittenTrip


def trips_command(  # noqa: PLR0917 -- Typer makes options of them
    out: Annotated[Path, typer.Option(help="Folder for the drives, one a trip.")],
    vehicles: Annotated[int, typer.Option(help="Cars, each with a receiver and nothing else.")] = 7,
    trips: Annotated[int, typer.Option(help="Of each vehicle.")] = 15,
    start: Annotated[
        dt.datetime, typer.Option(formats=["%Y-%m-%d"], help="The first day.")
    ] = dt.datetime(2026, 5, 4),
    seed: Annotated[int, typer.Option(help="Other seeds, other trips.")] = 1,
    force: Annotated[bool, typer.Option("--force", help="Write into a folder with files.")] = False,
) -> None:
    """Make trips as a tracker of papers/003 tells them: holes, and fixes of few satellites."""
    if not force:
        check_empty(out)
    from wayline_simulator.trips.files import simulate_trips  # noqa: PLC0415  -- slow to import
    from wayline_simulator.trips.model import TripsModel  # noqa: PLC0415

    asked = {"seed": seed, "vehicles": vehicles, "trips": trips, "start": start.date()}
    simulate_trips(fitted(asked, TripsModel, "wayline simulate trips"), out, _print_trip)


def _print_trip(trip: "WrittenTrip") -> None:
    typer.echo(f"{trip.folder}: {trip.distance_m / 1000.0:.2f} km, {trip.fixes:,} fixes")
