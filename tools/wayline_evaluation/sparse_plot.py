"""Fixes that come seldom, as a picture."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from wayline_evaluation.figures import ELLIPSES
from wayline_evaluation.plots import new_figure, save_figure
from wayline_evaluation.sparse import SparseRun

SHOWN_MAX = 12
ROW_INCHES = 2.2


def plot_sparse(runs: Sequence[SparseRun], path: Path) -> None:
    """The distance from the reference over time, fixes as ticks, 2 sigma shaded."""
    shown = runs[:SHOWN_MAX]
    figure = new_figure(11.0, 1.0 + ROW_INCHES * len(shown))
    for axes, run in zip(np.atleast_1d(figure.subplots(len(shown), 1)), shown, strict=True):
        errors, score = run.errors, run.score
        start_s = run.fixes_s[0]
        seconds = errors.times_s - start_s
        # the ellipse's mean radius
        radius_m = np.sqrt(ELLIPSES[1] * 0.5 * (errors.east_std_m**2 + errors.north_std_m**2))
        axes.fill_between(seconds, 0.0, radius_m, color="C0", alpha=0.15, lw=0.0)
        axes.plot(seconds, errors.horizontal_m, color="C0", lw=0.8)
        axes.plot(run.fixes_s - start_s, np.zeros(len(run.fixes_s)), "|", color="C3", ms=8)
        top_m = np.nanpercentile(errors.horizontal_m, 99.5)
        axes.set(xlim=(0.0, seconds[-1]), ylim=(0.0, 1.2 * top_m), ylabel="m")
        axes.set_title(f"{score.drive}, a fix every {score.every_s:g} s", loc="left", fontsize=9)
        axes.grid(visible=True, alpha=0.3)
    axes.set(xlabel="time, s (line: pose to reference; shaded: 2 sigma; ticks: fixes)")
    save_figure(figure, path)
