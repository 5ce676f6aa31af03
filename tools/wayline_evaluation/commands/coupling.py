"""`wayline evaluate`: what the vehicle's velocity is worth to a receiver.

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
    Plot,
    check_targets,
    progress,
    tell,
)

coupling_app = typer.Typer()


@coupling_app.command("tracking")
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
    tell(tracking_tables(report), report, json)
    if plot is not None:
        plot_tracking(report, plot)


@coupling_app.command("aiding")
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
    tell([aiding_table(report)], report, json)
