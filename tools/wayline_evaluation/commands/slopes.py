"""`wayline evaluate`: the slope of roads, and the sensors it comes from.

Each command imports what it needs when it runs, so that `--help` answers at once.
"""
# ruff: noqa: PLC0415

from pathlib import Path
from typing import Annotated

import typer

from wayline_evaluation.commands.asking import (
    Drives,
    Jobs,
    Json,
    Out,
    Plot,
    Yardstick,
    check_targets,
    progress,
    tell,
)

slopes_app = typer.Typer()


@slopes_app.command("slope")
def slope_command(
    drives: Drives,
    *,
    reference: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE.csv",
            help="The road's grade by place (as slope export writes it) in place of the truth.",
        ),
    ] = None,
    resolution: Annotated[
        list[float] | None,
        typer.Option(
            min=1.0, max=100.0, help="Length of the map's bins, m [default: 1 20 100]; repeatable."
        ),
    ] = None,
    out: Out = None,
    json: Json = None,
    plot: Plot = None,
    jobs: Jobs = 1,
    yardstick: Yardstick = False,
) -> None:
    """Grade from each sensor alone and from all, live and in the map, on runs of one road.

    Against the truth, a reference, or, where there is neither, run against run.
    """
    from wayline_evaluation.replays import Options
    from wayline_evaluation.slope_plot import plot_slope
    from wayline_evaluation.slope_reference import read_road
    from wayline_evaluation.slope_study import RESOLUTIONS_M, slope_study
    from wayline_evaluation.slope_table import slope_tables

    check_targets(json, plot)
    road = None if reference is None else read_road(reference)
    with progress("drives") as progressed:
        report, profiles, drivings = slope_study(
            drives,
            Options(out=out, jobs=jobs, yardstick=yardstick),
            progressed,
            reference=road,
            resolutions_m=tuple(sorted(set(resolution or RESOLUTIONS_M))),
        )
    tell(slope_tables(report), report, json)
    if plot is not None:
        plot_slope(profiles, [driving.mass_kg for driving in drivings], plot)


@slopes_app.command("slope-map")
def slope_map_command(drives: Drives, *, json: Json = None, plot: Plot = None) -> None:
    """The slope map after each of several drives over one road, beside the first one's truth."""
    from wayline_evaluation.slope_map_study import map_study
    from wayline_evaluation.slope_plot import plot_slope_map
    from wayline_evaluation.slope_table import slope_map_tables

    check_targets(json, plot)
    with progress() as progressed:
        report, shown = map_study(drives, progressed)
    tell(slope_map_tables(report), report, json)
    if plot is not None:
        plot_slope_map(report, shown, plot)


@slopes_app.command("sensors")
def sensors_command(
    drives: Annotated[
        list[Path], typer.Argument(help="Drives' folders, or NMEA logs with dates; pooled.")
    ],
    *,
    beside: Annotated[
        list[Path] | None,
        typer.Option(help="A drive to compare with, in a column of its own; may be repeated."),
    ] = None,
    json: Json = None,
    plot: Plot = None,
) -> None:
    """What sensors do at rest and from sample to sample; a receiver's errors where truth is."""
    from wayline_evaluation.sensor_plots import plot_sensors
    from wayline_evaluation.sensor_study import sensor_study
    from wayline_evaluation.sensor_tables import sensor_tables

    check_targets(json, plot)
    with progress("drives") as progressed:
        report, groups = sensor_study(drives, beside or [], progressed)
    tell(sensor_tables(report, groups), report, json)
    if plot is not None:
        plot_sensors(groups, plot)
