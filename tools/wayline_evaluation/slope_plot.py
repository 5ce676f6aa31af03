"""The pictures of `wayline evaluate slope` and `slope-map`."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from wayline_evaluation.plots import new_figure, save_figure
from wayline_evaluation.slope import Profiles
from wayline_evaluation.slope_map_study import MapReport, MapShown

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from wayline_evaluation.estimates import Floats

SENSORS = ("gps", "barometer", "torque", "vehicle")
COLUMNS = (("filter of papers/004", "{}"), ("live", "live_{}"), ("map, each run", "map_{}"))
TOGETHER = {"filter of papers/004": "yardstick", "live": "fusion", "map, each run": "map"}
SHOWN_PCT = 1.3
"""Of the steepest true slope, either way; filters that start swing further."""


def plot_slope(
    profiles: Profiles, masses_kg: "Sequence[tuple[Floats, Floats]]", path: Path
) -> None:
    """A row a sensor and one for all together, a column a way to use it; the mass beneath."""
    rows = [row for row in _rows() if any(name in profiles.ways for name in row)]
    figure = new_figure(15.0, 2.0 * (len(rows) + 1))
    grid = figure.add_gridspec(len(rows) + 1, len(COLUMNS))
    for place, names in enumerate(rows):
        for column, name in enumerate(names):
            axes = figure.add_subplot(grid[place, column])
            _profile(axes, profiles, name)
            if place == 0:
                axes.set(title=COLUMNS[column][0])
    _masses(figure.add_subplot(grid[len(rows), :]), masses_kg)
    save_figure(figure, path)


def _rows() -> list[tuple[str, ...]]:
    alone = [tuple(name.format(sensor) for _, name in COLUMNS) for sensor in SENSORS]
    return [*alone, tuple(TOGETHER.values())]


def _profile(axes: "Axes", profiles: Profiles, name: str) -> None:
    if name not in profiles.ways:
        axes.set_axis_off()
        return
    grades_pct = profiles.ways[name]
    axes.plot(profiles.distances_m / 1000.0, profiles.true_pct, color="0.7", lw=3.0)
    axes.plot(profiles.distances_m / 1000.0, grades_pct.T, lw=0.8)
    shown = grades_pct if profiles.against == "each other" else profiles.true_pct
    most_pct = SHOWN_PCT * float(np.nanmax(np.abs(shown)))
    axes.set(ylabel=f"{name.replace('_', ' ')}, %", ylim=(-most_pct, most_pct))
    axes.grid(visible=True, alpha=0.3)


def _masses(axes: "Axes", masses_kg: "Sequence[tuple[Floats, Floats]]") -> None:
    for travelled_m, mass_kg in masses_kg:
        axes.plot(travelled_m / 1000.0, mass_kg / 1000.0, lw=1.0)
    axes.set(xlabel="distance, km (grey: truth, thin: a run each)", ylabel="mass, t")
    axes.grid(visible=True, alpha=0.3)


def plot_slope_map(report: MapReport, shown: Sequence[MapShown], path: Path) -> None:
    """The map after each run beside the truth, and its errors with the std that is claimed."""
    figure = new_figure(13.0, 2.2 * len(shown))
    axes = figure.subplots(len(shown), 2, sharex=True, squeeze=False)
    for row, each, found in zip(axes, shown, report.after, strict=True):
        way_km, errors_pct = each.distances_m / 1000.0, each.grades_pct - each.true_pct
        row[0].plot(way_km, each.true_pct, color="0.7", lw=3.0)
        row[0].plot(way_km, each.grades_pct, lw=0.8)
        row[1].fill_between(way_km, -each.stds_pct, each.stds_pct, color="0.85", lw=0.0)
        row[1].plot(way_km, errors_pct, lw=0.8)
        row[0].set(ylabel=f"after {found.runs}: grade, %")
        row[1].set(ylabel=f"error, %, rms {found.rms_pct:.2f}", ylim=(-1.0, 1.0))
    for one in axes[-1]:
        one.set(xlabel="distance, km (grey: truth; claimed std)")
    save_figure(figure, path)
