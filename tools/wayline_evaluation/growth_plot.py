"""Architectures as a picture: how errors grow in outages of GPS."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from wayline_evaluation.architectures import PAPER, PAPER_OUTAGES, PAPER_PCT
from wayline_evaluation.growth import EVERY_M, Growth
from wayline_evaluation.plots import new_figure, save_figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes

LEAST_M = 0.1
"""Smaller errors lie on the lower edge: the axis is logarithmic."""
DASHES = ("-", "-", "-", "--")
"""The papers' two filters for GPS alone lie on each other where no fix is bad."""
ROW_HEIGHT = 3.6
LEGEND_WIDTH = 6
MARGIN = 1.04
"""Room for a mark at the very end."""


def plot_growth(growths: Sequence[Growth], path: Path) -> None:
    """Median and p90 of each architecture, over time and over the way; a row a duration."""
    durations_s = sorted({growth.duration_s for growth in growths})
    figure = new_figure(10.0, ROW_HEIGHT * len(durations_s))
    rows = figure.subplots(len(durations_s), 2, sharey=True, squeeze=False)
    for (by_time, by_distance), duration_s in zip(rows, durations_s, strict=True):
        shown = [growth for growth in growths if growth.duration_s == duration_s]
        for number, growth in enumerate(shown):
            dashes = DASHES[number % len(DASHES)]
            style = {"color": f"C{number}", "label": growth.filter, "linestyle": dashes}
            _band(by_time, growth.times_s, growth.p50_m, growth.p90_m, style)
            over = growth.over_distance_p50_m, growth.over_distance_p90_m
            _band(by_distance, growth.distances_m, *over, style)
        by_time.set(ylabel=f"{shown[0].count} outages of {duration_s:g} s: error, m")
        by_time.set_xlim(0.0, MARGIN * duration_s)
        furthest_m = max(max(growth.distances_m, default=1.0) for growth in shown)
        by_distance.set_xlim(0.0, MARGIN * furthest_m)
        _printed(by_time, by_distance, furthest_m)
    handles, labels = rows[0, 1].get_legend_handles_labels()
    figure.legend(handles, labels, fontsize="small", loc="outside upper center", ncols=LEGEND_WIDTH)
    rows[-1, 0].set(xlabel="time without GPS, s (lines: median, shaded up to p90)")
    rows[-1, 1].set(xlabel="distance without GPS, m")
    save_figure(figure, path)


def _band(
    axes: "Axes",
    places: Sequence[float],
    middle_m: Sequence[float],
    high_m: Sequence[float],
    style: dict[str, str],
) -> None:
    low, high = np.maximum(middle_m, LEAST_M), np.maximum(high_m, LEAST_M)
    axes.semilogy(places, low, lw=1.5, **style)
    axes.fill_between(places, low, high, color=style["color"], alpha=0.15, lw=0.0)
    axes.grid(visible=True, alpha=0.3)


def _printed(by_time: "Axes", by_distance: "Axes", furthest_m: float) -> None:
    """papers/001's outages, which are cross-track errors, where the axes reach them."""
    way_m = np.linspace(EVERY_M, furthest_m)
    label = f"{PAPER}: {PAPER_PCT:g} % (cross-track)"
    by_distance.plot(way_m, PAPER_PCT / 100.0 * way_m, "k:", label=label)
    errors_m = [each.cross_track_m for each in PAPER_OUTAGES]
    for axes, places in (
        (by_time, [each.duration_s for each in PAPER_OUTAGES]),
        (by_distance, [each.distance_m for each in PAPER_OUTAGES]),
    ):
        axes.plot(places, errors_m, "k+", ms=8, label=f"{PAPER}: its outages")
