"""The sensor study as a picture: what a table of figures cannot show."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from wayline_evaluation.estimates import Floats
from wayline_evaluation.plots import new_figure, save_figure
from wayline_evaluation.sensor_gps import DRIFT_WINDOW_S, correlation_curve, rest_tracks_m
from wayline_evaluation.sensor_models import allan_model, correlation_model
from wayline_evaluation.sensor_study import Group
from wayline_evaluation.sensor_vehicle import gyro_figures, rest_rates_degps

if TYPE_CHECKING:
    from matplotlib.axes import Axes

LAGS_S = np.unique(np.round(np.logspace(0.0, np.log10(300.0), 40)))
SHOWN_S = 3.0
"""Of a gyro at rest: longer, the steps of a hundred samples a second are a solid block."""
TRACKS_MAX = 12
"""More standstills hide each other."""
ROW_GAP = 6.0
"""Space between two gyros' rows, in standard deviations of the noisiest."""


def plot_sensors(groups: Sequence[Group], path: Path) -> None:
    """Gyro on the left, GPS on the right; a colour a column of the table."""
    figure = new_figure(11.0, 8.5)
    ((allan, correlation), (standing, places)) = figure.subplots(2, 2)
    _allan(allan, groups)
    _correlation(correlation, groups)
    _standing(standing, groups)
    _places(places, groups)
    save_figure(figure, path)


def _allan(axes: "Axes", groups: Sequence[Group]) -> None:
    for number, group in enumerate(groups):
        figures = gyro_figures(group.records)
        if figures is None or not figures.allan:
            continue
        taus_s = np.array([point.tau_s for point in figures.allan])
        found = [point.deviation_degps for point in figures.allan]
        axes.loglog(taus_s, found, f"C{number}.-", ms=4, lw=1.0, label=group.title)
        facts = group.records[0].facts
        model = allan_model(facts.gyro, taus_s) if facts and facts.gyro else None
        if model is not None:
            axes.loglog(taus_s, model, f"C{number}--", lw=1.0)
    axes.set(
        title="gyro at rest (dashed: its model)",
        xlabel="averaging time, s",
        ylabel="Allan deviation, deg/s",
    )
    _finish(axes)


def _correlation(axes: "Axes", groups: Sequence[Group]) -> None:
    for number, group in enumerate(groups):
        points = correlation_curve(group.records, list(LAGS_S))
        lags_s = np.array([point.lag_s for point in points])
        for name, style in (("horizontal", "-"), ("up", ":")):
            found = np.array([getattr(point, name) for point in points], dtype=np.float64)
            if not np.isnan(found).all():
                label = f"{group.title}, {name}"
                axes.semilogx(lags_s, found, f"C{number}{style}", lw=1.2, label=label)
        facts = group.records[0].facts
        if facts is not None and facts.gps is not None and len(lags_s):
            axes.semilogx(lags_s, correlation_model(facts.gps, lags_s), f"C{number}--", lw=1.0)
    axes.set(
        title="GPS error (dashed: its model, horizontal)",
        xlabel="lag, s",
        ylabel="autocorrelation",
        ylim=(-0.4, 1.05),
    )
    _finish(axes)


def _standing(axes: "Axes", groups: Sequence[Group]) -> None:
    longest = [(group.title, _longest(group)) for group in groups]
    shown = [(number, title, piece) for number, (title, piece) in enumerate(longest) if len(piece)]
    gap = ROW_GAP * max((float(piece.std()) for _, _, piece in shown), default=1.0)
    for row, (number, title, piece) in enumerate(shown):
        rate_hz = _rate_hz(groups[number])
        seen = piece[: int(SHOWN_S * rate_hz)]
        seconds = np.arange(len(seen)) / rate_hz
        level = seen - seen.mean() - row * gap
        axes.step(seconds, level, f"C{number}", lw=0.8, label=f"{title}, {seen.mean():+.2f} deg/s")
    axes.set(
        title="gyro in a standstill, less its mean; one above the other",
        xlabel="time, s",
        ylabel="yaw rate, deg/s",
    )
    _finish(axes)


def _places(axes: "Axes", groups: Sequence[Group]) -> None:
    for number, group in enumerate(groups):
        for count, track_m in enumerate(rest_tracks_m(group.records, DRIFT_WINDOW_S)):
            if count == TRACKS_MAX:
                break
            east_m, north_m = (track_m - track_m.mean(axis=0)).T
            label = group.title if count == 0 else None
            axes.plot(east_m, north_m, f"C{number}.-", ms=3, lw=0.5, alpha=0.7, label=label)
    axes.set(
        title="fixes in 10 s of standing, about their mean",
        xlabel="east, m",
        ylabel="north, m",
        aspect="equal",
    )
    axes.set_adjustable("datalim")
    _finish(axes)


def _longest(group: Group) -> Floats:
    return max(rest_rates_degps(group.records), key=len, default=np.empty(0))


def _rate_hz(group: Group) -> float:
    figures = gyro_figures(group.records)
    return figures.rate_hz if figures else 1.0


def _finish(axes: "Axes") -> None:
    axes.grid(visible=True, which="both", alpha=0.25)
    if axes.get_legend_handles_labels()[0]:
        axes.legend(fontsize="small")
