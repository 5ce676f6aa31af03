"""Studies as pictures."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from wayline.errors import InputError
from wayline_evaluation.accuracy import ScoredDrive
from wayline_evaluation.outages import OutageReport

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

COLOURS = {"fusion": "C0", "yardstick": "C1"}
OVER_TIME = (
    ("cross_track_m", None, "cross-track, m"),
    ("along_track_m", None, "along-track, m"),
    ("heading_deg", "heading_std_deg", "heading, deg"),
    ("speed_mps", "speed_std_mps", "speed, m/s"),
    ("alt_m", "alt_std_m", "altitude, m"),
    ("grade_pct", "grade_std_pct", "grade, %"),
)
DPI = 100
GUIDES_PCT = (0.5, 1.0, 2.0, 5.0)
"""Shares of the distance, the last being papers/001's average cross-track error."""


def plot_accuracy(drives: Sequence[ScoredDrive], path: Path) -> None:
    """How errors are distributed over all drives, and how they went on the first."""
    first = drives[0]
    shown = [
        row for row in OVER_TIME if not np.isnan(getattr(first.errors["fusion"], row[0])).all()
    ]
    figure = new_figure(11.0, 4.0 + 2.0 * len(shown))
    axes = figure.subplots(len(shown) + 1, 1, height_ratios=[2.0] + [1.0] * len(shown))
    _distribution(axes[0], drives)
    for one, (name, std, title) in zip(axes[1:], shown, strict=True):
        _over_time(one, first, name, std)
        one.set(ylabel=title)
        one.grid(visible=True, alpha=0.3)
    axes[-1].set(xlabel=f"{first.drive}: time, s (shaded: 2 sigma; grey: dead reckoning)")
    save_figure(figure, path)


def _distribution(axes: "Axes", drives: Sequence[ScoredDrive]) -> None:
    for filter_, colour in COLOURS.items():
        for drive in drives:
            if filter_ not in drive.errors:
                continue
            errors_m = np.sort(drive.errors[filter_].horizontal_m)
            errors_m = errors_m[~np.isnan(errors_m)]
            shares = np.arange(1, len(errors_m) + 1) / len(errors_m)
            label = filter_ if drive is drives[0] else None
            axes.semilogx(np.maximum(errors_m, 1e-2), shares, color=colour, label=label, lw=1.0)
    against = "truth" if drives[0].reference == "truth" else "recorded fix"
    axes.set(xlabel=f"pose to {against}, m", ylabel="share of poses", ylim=(0.0, 1.0))
    axes.grid(visible=True, which="both", alpha=0.3)
    axes.legend()


def _over_time(axes: "Axes", drive: ScoredDrive, name: str, std: str | None) -> None:
    fusion = drive.errors["fusion"]
    start_s = float(fusion.times_s[0])
    for filter_, errors in drive.errors.items():
        colour = COLOURS[filter_]
        axes.plot(errors.times_s - start_s, getattr(errors, name), color=colour, lw=0.7)
    seconds, values = fusion.times_s - start_s, getattr(fusion, name)
    axes.set_xlim(seconds[0], seconds[-1])
    if std is not None:
        bound = 2.0 * getattr(fusion, std)
        axes.fill_between(seconds, -bound, bound, color=COLOURS["fusion"], alpha=0.15, lw=0.0)
    low, high = np.nanpercentile(values, [0.1, 99.9])
    margin = 0.3 * max(high - low, 1e-3)
    axes.set_ylim(low - margin, high + margin)
    upright = axes.get_xaxis_transform()
    blind = fusion.dead_reckoning
    axes.fill_between(seconds, 0.0, 1.0, where=blind, color="0.85", transform=upright, lw=0.0)


def plot_outages(report: OutageReport, path: Path) -> None:
    """Where poses ended up at the end of outages, and what share of the way that is."""
    figure = new_figure(11.0, 5.5)
    places, shares = figure.subplots(1, 2)
    for name, colour in COLOURS.items():
        scores = [score for score in report.outages if score.filter == name]
        if not scores:
            continue
        along = [score.along_track_m for score in scores]
        across = [score.cross_track_m for score in scores]
        places.scatter(across, along, color=colour, s=16, label=name)
        lengths_m = [score.distance_m for score in scores]
        shares.scatter(lengths_m, [score.horizontal_m for score in scores], color=colour, s=16)
    places.axhline(0.0, color="0.7", lw=0.8)
    places.axvline(0.0, color="0.7", lw=0.8)
    places.set(xlabel="cross-track (right), m", ylabel="along-track (ahead), m", aspect="equal")
    places.set_adjustable("datalim")
    places.legend()
    for percent in GUIDES_PCT:
        shares.axline((0.0, 0.0), slope=percent / 100.0, color="0.8", lw=0.8)
    highest_m = max((score.horizontal_m for score in report.outages), default=1.0)
    guides = ", ".join(f"{percent:g}" for percent in GUIDES_PCT)
    shares.set(
        xlabel=f"distance in the outage, m (grey: {guides} %)",
        ylabel="horizontal error at its end, m",
        xlim=(0.0, None),
        ylim=(0.0, 1.1 * highest_m),
    )
    save_figure(figure, path)


def new_figure(width: float, height: float) -> "Figure":
    """An empty one, inches."""
    from matplotlib.figure import Figure  # noqa: PLC0415  -- slow to import

    return Figure(figsize=(width, height), layout="constrained")


def save_figure(figure: "Figure", path: Path) -> None:
    """Write it as PNG. Raises InputError."""
    try:
        figure.savefig(path, dpi=DPI)
    except (OSError, ValueError) as error:
        raise InputError("--plot", str(error), "name a PNG file that can be written") from None
