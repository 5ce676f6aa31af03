"""The study as a picture: figure 4 of papers/003, and speeds amid bad fixes (figure 3)."""

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from wayline_evaluation.estimates import Floats
from wayline_evaluation.plots import new_figure, save_figure
from wayline_evaluation.smoothing.modified_kalman import MILE_M
from wayline_evaluation.smoothing.report import SmoothingReport
from wayline_evaluation.smoothing.smoothers import Made, Method
from wayline_evaluation.smoothing.trip import Trip

if TYPE_CHECKING:
    from matplotlib.axes import Axes

COLOURS: dict[Method, str] = {
    "least_squares_spline": "C4",
    "kernel": "C2",
    "kalman": "C1",
    "modified_kalman": "C3",
    "rts": "C0",
    "fusion": "C5",
}
SHOWN_S = 90.0
"""Of the trip whose speeds are shown, around its worst bad fix."""


def plot_smoothing(
    report: SmoothingReport, trip: Trip, made: Mapping[Method, Made], path: Path
) -> None:
    """Distances of trips over the reference's, and one trip's speeds and accelerations."""
    figure = new_figure(11.0, 12.0)
    distances, speeds, accelerations = figure.subplots(3, 1, height_ratios=[2.0, 1.0, 1.0])
    _distances(distances, report)
    around = _around(trip)
    wanted_mps, times_s = trip.reference.speeds_mps, trip.track.times_s
    told = {name: each.speeds_mps for name, each in made.items()}
    _series(speeds, trip, wanted_mps, told, around)
    inside = (times_s >= around[0]) & (times_s <= around[1])
    speeds.plot(times_s[inside], trip.told_mps[inside], ".", color="0.5", ms=4)
    shown = "figure 3; thick: reference, dots: as told, shaded: bad fixes"
    speeds.set(ylabel="speed, m/s", title=f"{trip.name} ({shown})")
    slopes = {name: np.gradient(each, times_s) for name, each in told.items()}
    _series(accelerations, trip, np.gradient(wanted_mps, times_s), slopes, around)
    accelerations.set(ylabel="acceleration, m/s2", xlabel="time, s")
    save_figure(figure, path)


def _distances(axes: "Axes", report: SmoothingReport) -> None:
    for name in report.methods:
        there = [each for each in report.trips if name in each.distance_m]
        reference_mile = [each.reference_m / MILE_M for each in there]
        error_mile = [(each.distance_m[name] - each.reference_m) / MILE_M for each in there]
        axes.plot(reference_mile, error_mile, ".", color=COLOURS[name], ms=5, label=name)
    axes.set_yscale("symlog", linthresh=0.01)
    axes.set(
        xlabel="distance of a trip by the reference, mile",
        ylabel="method minus reference, mile",
        title="distances of trips (figure 4)",
    )
    axes.grid(visible=True, alpha=0.3)
    axes.legend(ncols=3, loc="lower right")


def _around(trip: Trip) -> tuple[float, float]:
    """Where the told speed is farthest from the reference's among the bad fixes, or all."""
    errors_mps = np.nan_to_num(np.abs(trip.told_mps - trip.reference.speeds_mps))
    if not trip.track.good.all():
        errors_mps[trip.track.good] = -1.0
    times_s = trip.track.times_s
    latest_s = max(float(times_s[-1]) - SHOWN_S, 0.0)
    begin_s = min(max(float(times_s[int(np.argmax(errors_mps))]) - SHOWN_S / 2.0, 0.0), latest_s)
    return begin_s, begin_s + SHOWN_S


def _series(
    axes: "Axes",
    trip: Trip,
    reference: Floats,
    series: Mapping[Method, Floats],
    around: tuple[float, float],
) -> None:
    times_s = trip.track.times_s
    inside = (times_s >= around[0]) & (times_s <= around[1])
    upright = axes.get_xaxis_transform()
    axes.fill_between(
        times_s, 0.0, 1.0, where=~trip.track.good, transform=upright, color="0.9", lw=0.0
    )
    axes.plot(times_s[inside], reference[inside], color="0.2", lw=2.5)
    for name, values in series.items():
        axes.plot(times_s[inside], values[inside], color=COLOURS[name], lw=1.0, label=name)
    axes.set(xlim=around)
    axes.grid(visible=True, alpha=0.3)
