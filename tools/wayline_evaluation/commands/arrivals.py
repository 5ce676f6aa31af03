"""`wayline evaluate`: trips found and followed, and arrivals told.

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
    check_targets,
    progress,
    tell,
)

arrivals_app = typer.Typer()


@arrivals_app.command("trips")
def trips_command(
    drives: Drives,
    *,
    feed: Annotated[list[Path], typer.Option(help="A GTFS feed; may be repeated.")],
    out: Out = None,
    json: Json = None,
    jobs: Jobs = 1,
) -> None:
    """Whether the trip of a timetable that a vehicle runs is found, on drives that tell it."""
    from wayline_evaluation.replays import Options
    from wayline_evaluation.trip_study import trip_study
    from wayline_evaluation.trip_table import trip_table

    check_targets(json, None)
    with progress() as progressed:
        report = trip_study(drives, feed, Options(out=out, jobs=jobs), progressed)
    tell([trip_table(report)], report, json)


@arrivals_app.command("eta")
def eta_command(
    drives: Drives,
    *,
    route: Annotated[list[Path] | None, typer.Option(help="A route; may be repeated.")] = None,
    feed: Annotated[list[Path] | None, typer.Option(help="A GTFS feed; may be repeated.")] = None,
    database: Annotated[
        str | None, typer.Option(help="URL; each drive builds on what those before have taught.")
    ] = None,
    from_lap: Annotated[
        int, typer.Option(min=1, help="Score what was told from this lap or trip of a drive on.")
    ] = 1,
    out: Out = None,
    json: Json = None,
    plot: Plot = None,
    jobs: Jobs = 1,
    yardstick: Annotated[
        bool,
        typer.Option(
            "--yardstick",
            help="Compare with who is told a simulated network's streets, or all other laps.",
        ),
    ] = False,
) -> None:
    """How good predicted arrivals were, by minutes ahead, against when the vehicle came."""
    from wayline_evaluation.eta_plot import plot_eta
    from wayline_evaluation.eta_study import Followed, eta_study
    from wayline_evaluation.eta_table import eta_tables
    from wayline_evaluation.replays import Options

    check_targets(json, plot)
    with progress() as progressed:
        options = Options(out=out, jobs=jobs, yardstick=yardstick)
        followed = Followed(tuple(route or ()), tuple(feed or ()), database, from_lap)
        report, runs = eta_study(drives, followed, options, progressed)
    tell(eta_tables(report), report, json)
    if plot is not None:
        plot_eta(report, runs, plot)


@arrivals_app.command("avl")
def avl_command(
    folder: Annotated[Path, typer.Argument(help="Folder with the tables of papers/000 as CSV.")],
    *,
    route: Annotated[
        Path | None, typer.Option(help="A route in place of the planned one of the tables.")
    ] = None,
    json: Json = None,
    plot: Plot = None,
) -> None:
    """The published route filter beside its printed estimates, and its ellipses."""
    from wayline_evaluation.avl_plot import plot_avl
    from wayline_evaluation.avl_study import avl_study
    from wayline_evaluation.avl_table import avl_tables

    check_targets(json, plot)
    study = avl_study(folder, route)
    tell(avl_tables(study.report), study.report, json)
    if plot is not None:
        plot_avl(study, plot)


@arrivals_app.command("following")
def following_command(
    drives: Drives,
    *,
    feed: Annotated[list[Path], typer.Option(help="A GTFS feed; may be repeated.")],
    out: Out = None,
    json: Json = None,
    jobs: Jobs = 1,
) -> None:
    """How well vehicles are followed along their trips and their arrivals told."""
    from wayline_evaluation.arrival_study import arrival_study
    from wayline_evaluation.arrival_table import arrival_table
    from wayline_evaluation.replays import Options

    check_targets(json, None)
    with progress() as progressed:
        report = arrival_study(drives, feed, Options(out=out, jobs=jobs), progressed)
    tell([arrival_table(report)], report, json)
