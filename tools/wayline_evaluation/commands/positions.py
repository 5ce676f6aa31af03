"""`wayline evaluate`: where vehicles were, and how far they went.

Each command imports what it needs when it runs, so that `--help` answers at once.
"""
# ruff: noqa: PLC0415

from typing import Annotated

import typer

from wayline.errors import InputError
from wayline_evaluation.commands.asking import (
    Drives,
    Jobs,
    Json,
    Out,
    Plot,
    Without,
    Yardstick,
    check_targets,
    progress,
    tell,
)

positions_app = typer.Typer()
EVERY_S = (5.0, 15.0, 30.0, 60.0)
"""As trackers, phones and transit systems report."""


@positions_app.command("accuracy")
def accuracy_command(
    drives: Drives,
    *,
    gps_outage: Annotated[
        list[str] | None,
        typer.Option(
            metavar="START_S:LENGTH_S",
            help="Take GPS away for a while, counted from the drive's start; may be repeated.",
        ),
    ] = None,
    without: Without = None,
    out: Out = None,
    json: Json = None,
    plot: Plot = None,
    jobs: Jobs = 1,
    yardstick: Yardstick = False,
) -> None:
    """Errors of all poses against the truth, or the recorded fixes where there is none."""
    from wayline_evaluation.accuracy_study import accuracy_study
    from wayline_evaluation.plots import plot_accuracy
    from wayline_evaluation.replays import Options
    from wayline_evaluation.tables import accuracy_tables
    from wayline_replay.outages import parse_outage
    from wayline_replay.stream import check_outages_of
    from wayline_replay.withheld import withheld_of

    outages = [parse_outage(text) for text in gps_outage or []]
    check_targets(json, plot)
    for drive in drives:
        check_outages_of(drive, outages)
    with progress() as progressed:
        options = Options(out, jobs, yardstick, withheld_of(without))
        report, scored = accuracy_study(drives, outages, options, progressed)
    tell(accuracy_tables(report), report, json)
    if plot is not None:
        plot_accuracy(scored, plot)


@positions_app.command("outages")
def outages_command(
    drives: Drives,
    *,
    length: Annotated[
        list[float] | None, typer.Option(help="Seconds without GPS [default: 60]; may be repeated.")
    ] = None,
    every: Annotated[
        float | None, typer.Option(help="Seconds from outage to outage [default: length + 120].")
    ] = None,
    start: Annotated[float, typer.Option(min=0.0, help="Seconds before the first.")] = 240.0,
    passes: Annotated[
        int, typer.Option(min=1, help="Replays of a drive, outages moved on each time.")
    ] = 1,
    architectures: Annotated[
        str | None,
        typer.Option(
            metavar="NAME,...",
            help="Compare these: loose, measurement, uncoupled, gps_only, gps_only_modified; "
            "papers/001 beside.",
        ),
    ] = None,
    satellites: Annotated[
        int, typer.Option(min=0, help="So many are left in outages, by raw measurements alone.")
    ] = 0,
    without: Without = None,
    out: Out = None,
    json: Json = None,
    plot: Plot = None,
    jobs: Jobs = 1,
    yardstick: Yardstick = False,
) -> None:
    """Errors at the end of outages of GPS, as papers/001 lists them."""
    from wayline_evaluation.growth_plot import plot_growth
    from wayline_evaluation.outage_study import OutagePlan, architectures_of, outage_study
    from wayline_evaluation.plots import plot_outages
    from wayline_evaluation.replays import Options
    from wayline_evaluation.tables import architecture_tables, outage_tables
    from wayline_replay.withheld import withheld_of

    check_targets(json, plot)
    lengths_s = tuple(length or (60.0,))
    if min(lengths_s) <= 0.0:
        raise InputError("--length", f"{min(lengths_s):g} s is no outage", "give more than 0")
    compared = () if architectures is None else architectures_of(architectures)
    plan = OutagePlan(lengths_s, every, start, passes, compared, satellites)
    with progress() as progressed:
        options = Options(out, jobs, yardstick, withheld_of(without))
        report = outage_study(drives, plan, options, progressed)
    tell((architecture_tables if compared else outage_tables)(report), report, json)
    if plot is not None and compared:
        plot_growth(report.growths, plot)
    elif plot is not None:
        plot_outages(report, plot)


@positions_app.command("sparse")
def sparse_command(
    drives: Drives,
    *,
    every: Annotated[
        list[float] | None,
        typer.Option(min=0.0, help="Seconds from fix to fix [default: 5 15 30 60]; repeatable."),
    ] = None,
    without: Without = None,
    out: Out = None,
    json: Json = None,
    plot: Plot = None,
    jobs: Jobs = 1,
) -> None:
    """Errors at fixes that come seldom, as trackers report them, and before the next one."""
    from wayline_evaluation.replays import Options
    from wayline_evaluation.sparse_plot import plot_sparse
    from wayline_evaluation.sparse_study import sparse_study
    from wayline_evaluation.sparse_table import sparse_table
    from wayline_replay.withheld import withheld_of

    check_targets(json, plot)
    with progress() as progressed:
        options = Options(out=out, jobs=jobs, withheld=withheld_of(without))
        report, shown = sparse_study(drives, tuple(every or EVERY_S), options, progressed)
    tell([sparse_table(report)], report, json)
    if plot is not None:
        plot_sparse(shown, plot)


@positions_app.command("distance")
def distance_command(drives: Drives, *, json: Json = None, jobs: Jobs = 1) -> None:
    """How far each drive went, with its std, and by GPS alone beside truth, wheels or speeds."""
    from wayline_evaluation.distance_study import distance_study
    from wayline_evaluation.distance_table import distance_tables

    check_targets(json, None)
    with progress("drives") as progressed:
        report = distance_study(drives, jobs, progressed)
    tell(distance_tables(report), report, json)


@positions_app.command("smoothing")
def smoothing_command(
    drives: Drives,
    *,
    fusion: Annotated[
        int, typer.Option(min=0, help="Trips, spread evenly, that fusion is run on; it is slow.")
    ] = 5,
    json: Json = None,
    plot: Plot = None,
    jobs: Jobs = 1,
) -> None:
    """Speeds, accelerations and trip distances by six smoothers, as papers/003 compares them."""
    from wayline_evaluation.smoothing.plot import plot_smoothing
    from wayline_evaluation.smoothing.study import shown_trip, smoothing_study
    from wayline_evaluation.smoothing.table import smoothing_tables

    check_targets(json, plot)
    with progress("trips") as progressed:
        report = smoothing_study(drives, fusion, jobs, progressed)
    tell(smoothing_tables(report), report, json)
    if plot is not None:
        plot_smoothing(report, *shown_trip(drives, report), plot)
