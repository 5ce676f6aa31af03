"""The commands of `wayline evaluate`.

Each imports what it needs when it runs, so that `--help` answers at once.
"""
# ruff: noqa: PLC0415

from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

from wayline.errors import InputError

if TYPE_CHECKING:
    import msgspec
    from rich.table import Table

evaluate_app = typer.Typer(
    help="Studies of how good estimates are, on any drives.", no_args_is_help=True
)

FILE_WIDTH = 120
"""Where no terminal sets a width, tables are not cut."""
Drives = Annotated[list[Path], typer.Argument(help="Drives' folders (with drive.toml).")]
Out = Annotated[Path | None, typer.Option(help="Keep the replays in this folder.")]
Json = Annotated[Path | None, typer.Option("--json", help="File for programs to read.")]
Plot = Annotated[Path | None, typer.Option(metavar="FILE.png", help="Picture to write.")]
Jobs = Annotated[int, typer.Option(min=1, help="Replays at a time.")]
Yardstick = Annotated[
    bool,
    typer.Option("--yardstick", help="Compare with a filter that is told a simulation's noise."),
]

Without = Annotated[
    str | None,
    typer.Option(metavar="PART,...", help="Withhold these: can, gyro, course, speed (of fixes)."),
]
EVERY_S = (5.0, 15.0, 30.0, 60.0)
"""As trackers, phones and transit systems report."""


@evaluate_app.command("accuracy")
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
    _tell(accuracy_tables(report), report, json)
    if plot is not None:
        plot_accuracy(scored, plot)


@evaluate_app.command("outages")
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
    _tell((architecture_tables if compared else outage_tables)(report), report, json)
    if plot is not None and compared:
        plot_growth(report.growths, plot)
    elif plot is not None:
        plot_outages(report, plot)


@evaluate_app.command("sparse")
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
    _tell([sparse_table(report)], report, json)
    if plot is not None:
        plot_sparse(shown, plot)


@evaluate_app.command("distance")
def distance_command(drives: Drives, *, json: Json = None, jobs: Jobs = 1) -> None:
    """How far each drive went, with its std, and by GPS alone beside truth, wheels or speeds."""
    from wayline_evaluation.distance_study import distance_study
    from wayline_evaluation.distance_table import distance_tables

    check_targets(json, None)
    with progress("drives") as progressed:
        report = distance_study(drives, jobs, progressed)
    _tell(distance_tables(report), report, json)


@evaluate_app.command("smoothing")
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
    _tell(smoothing_tables(report), report, json)
    if plot is not None:
        plot_smoothing(report, *shown_trip(drives, report), plot)


@evaluate_app.command("trips")
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
    _tell([trip_table(report)], report, json)


@evaluate_app.command("eta")
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
    _tell(eta_tables(report), report, json)
    if plot is not None:
        plot_eta(report, runs, plot)


@evaluate_app.command("avl")
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
    _tell(avl_tables(study.report), study.report, json)
    if plot is not None:
        plot_avl(study, plot)


@evaluate_app.command("following")
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
    _tell([arrival_table(report)], report, json)


@evaluate_app.command("tracking")
def tracking_command(
    drive: Annotated[
        Path | None,
        typer.Argument(help="A drive whose motion and sky the loops meet; none: random motion."),
    ] = None,
    *,
    runs: Annotated[int, typer.Option(min=1, help="Loops simulated at each C/N0.")] = 100,
    seconds: Annotated[float, typer.Option(min=1.0, help="Length of each.")] = 60.0,
    seed: Annotated[int, typer.Option(min=0, help="Of noise and motion.")] = 1,
    json: Json = None,
    plot: Plot = None,
) -> None:
    """Carrier loops and search with and without the vehicle's velocity, as papers/001 has them."""
    from wayline_evaluation.tracking.plot import plot_tracking
    from wayline_evaluation.tracking.study import Plan, tracking_study
    from wayline_evaluation.tracking.table import tracking_tables

    check_targets(json, plot)
    with progress("loops") as progressed:
        plan = Plan(runs=runs, seconds=seconds, seed=seed)
        report = tracking_study(plan, drive, progressed)
    _tell(tracking_tables(report), report, json)
    if plot is not None:
        plot_tracking(report, plot)


@evaluate_app.command("aiding")
def aiding_command(
    drives: Drives,
    *,
    length: Annotated[float, typer.Option(min=1.0, help="Seconds without GPS.")] = 60.0,
    every: Annotated[float, typer.Option(help="Seconds from outage to outage.")] = 180.0,
    start: Annotated[float, typer.Option(min=0.0, help="Seconds before the first.")] = 240.0,
    json: Json = None,
    jobs: Jobs = 1,
) -> None:
    """Dopplers that fusion predicts for a receiver's loops, with GPS and without."""
    from wayline_evaluation.tracking.aiding_study import AidingPlan, aiding_study
    from wayline_evaluation.tracking.aiding_table import aiding_table

    check_targets(json, None)
    with progress() as progressed:
        plan = AidingPlan(length_s=length, every_s=every, start_s=start)
        report = aiding_study(drives, plan, jobs, progressed)
    _tell([aiding_table(report)], report, json)


@evaluate_app.command("slope")
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
    _tell(slope_tables(report), report, json)
    if plot is not None:
        plot_slope(profiles, [driving.mass_kg for driving in drivings], plot)


@evaluate_app.command("slope-map")
def slope_map_command(drives: Drives, *, json: Json = None, plot: Plot = None) -> None:
    """The slope map after each of several drives over one road, beside the first one's truth."""
    from wayline_evaluation.slope_map_study import map_study
    from wayline_evaluation.slope_plot import plot_slope_map
    from wayline_evaluation.slope_table import slope_map_tables

    check_targets(json, plot)
    with progress() as progressed:
        report, shown = map_study(drives, progressed)
    _tell(slope_map_tables(report), report, json)
    if plot is not None:
        plot_slope_map(report, shown, plot)


@evaluate_app.command("sensors")
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
    _tell(sensor_tables(report, groups), report, json)
    if plot is not None:
        plot_sensors(groups, plot)


def check_targets(json: Path | None, plot: Path | None) -> None:
    """Raise InputError for files that cannot be written, before the work and not after it."""
    from matplotlib.backend_bases import FigureCanvasBase

    for option, path in (("--json", json), ("--plot", plot)):
        if path is not None and not path.parent.is_dir():
            raise InputError(option, f"there is no folder {path.parent}", "make it or name another")
        if path is not None and path.is_dir():
            raise InputError(option, f"{path} is a folder", "name a file in it")
    kinds = FigureCanvasBase.get_supported_filetypes()
    if plot is not None and plot.suffix.lstrip(".").lower() not in kinds:
        mend = f"give one of {', '.join(f'.{kind}' for kind in sorted(kinds))}"
        raise InputError("--plot", f"{plot} is no kind of picture that can be written", mend)


def _tell(tables: "Iterable[Table]", report: "msgspec.Struct", json: Path | None) -> None:
    from msgspec import json as codec

    console = Console()
    if not console.is_terminal:
        console = Console(width=FILE_WIDTH)
    for table in tables:
        console.print(table)
        console.print()
    if json is not None:
        try:
            json.write_bytes(codec.format(codec.encode(report), indent=2) + b"\n")
        except OSError as error:
            reason = error.strerror or str(error)
            raise InputError("--json", reason, "name a file that can be written") from None


@contextmanager
def progress(what: str = "replays") -> Iterator[Callable[[int, int], None]]:
    """Shows on a terminal how many of several pieces of work are done."""
    console = Console(stderr=True)
    columns = (TextColumn(what), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
    with Progress(
        *columns, console=console, transient=True, disable=not console.is_terminal
    ) as bar:
        task = bar.add_task(what)

        def progressed(done: int, total: int) -> None:
            bar.update(task, completed=done, total=total)

        yield progressed
