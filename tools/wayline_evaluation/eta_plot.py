"""How good arrivals were, as a picture."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from wayline_eta.scores import Floats, cal_itp_bounds_s
from wayline_evaluation.eta import EtaReport, EtaRun
from wayline_evaluation.plots import new_figure, save_figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes

AHEAD_MIN = 30
QUANTILES = (0.1, 0.5, 0.9)
PROMISED = 0.8
"""Between p10 and p90."""
LEAST = 10
"""Predictions, for quantiles to say anything."""


def plot_eta(report: EtaReport, runs: Sequence[EtaRun], path: Path) -> None:
    """Errors by minutes ahead, how often ranges held, and how laps or trips grew better."""
    figure = new_figure(11.0, 10.0)
    errors, held, laps = figure.subplots(3, 1, height_ratios=(2.0, 1.0, 1.0))
    _errors(errors, runs)
    _held(held, report)
    _laps(laps, report)
    save_figure(figure, path)


def _errors(axes: "Axes", runs: Sequence[EtaRun]) -> None:
    rows = [
        (each.predicted_s, each.actual_s)
        for run in runs
        for each in run.predictions
        if each.actual_s is not None
    ]
    predicted_s, actual_s = np.array(rows, dtype=np.float64).reshape(-1, 2).T
    minutes, low_s, middle_s, high_s = _by_minute(predicted_s / 60.0, actual_s - predicted_s)
    axes.fill_between(minutes, low_s, high_s, color="C0", alpha=0.2, lw=0.0, label="80 % of errors")
    axes.plot(minutes, middle_s, color="C0", label="median")
    early_s, late_s = cal_itp_bounds_s(minutes)
    axes.plot(minutes, early_s, color="0.5", ls="--", lw=0.8, label="Cal-ITP's bounds")
    axes.plot(minutes, late_s, color="0.5", ls="--", lw=0.8)
    axes.axhline(0.0, color="0.7", lw=0.8)
    axes.set(xlabel="told to come in, min", ylabel="came later than told, s")
    axes.legend(loc="upper left")
    axes.grid(visible=True, alpha=0.3)


def _by_minute(ahead_min: Floats, errors_s: Floats) -> Floats:
    """Middles of minutes and the errors' quantiles there, shape (4, minutes)."""
    found = []
    for minute in range(AHEAD_MIN):
        within = errors_s[(ahead_min >= minute) & (ahead_min < minute + 1)]
        if len(within) >= LEAST:
            found.append((minute + 0.5, *np.quantile(within, QUANTILES)))
    return np.array(found, dtype=np.float64).reshape(-1, 1 + len(QUANTILES)).T


def _held(axes: "Axes", report: EtaReport) -> None:
    spans = [span for span in report.pooled.spans if span.held_share is not None]
    names = [f"{span.from_min:g}-{span.to_min:g}\n{span.count:,}" for span in spans]
    axes.bar(names, [100.0 * (span.held_share or 0.0) for span in spans], color="C0", width=0.6)
    axes.axhline(100.0 * PROMISED, color="0.5", ls="--", lw=0.8)
    axes.set(xlabel="minutes ahead; predictions", ylabel="p10-p90 holds, %", ylim=(0.0, 100.0))
    axes.grid(visible=True, axis="y", alpha=0.3)


def _laps(axes: "Axes", report: EtaReport) -> None:
    numbers = np.arange(1, len(report.laps) + 1)
    errors_s = [lap.mean_absolute_s for lap in report.laps]
    axes.plot(numbers, errors_s, "o-", color="C0", ms=3.0)
    axes.set(xlabel="lap or trip, in order", ylabel="mean absolute error, s", ylim=(0.0, None))
    axes.grid(visible=True, alpha=0.3)
