"""The study as a picture: figures 1, 8 and 9 of papers/001, and lock lost over C/N0."""

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from wayline_evaluation.plots import new_figure, save_figure
from wayline_evaluation.tracking.figures import FAMILY_DBHZ
from wayline_evaluation.tracking.fll import threshold_hz
from wayline_evaluation.tracking.loop import PAIR_S
from wayline_evaluation.tracking.report import TrackingReport

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def plot_tracking(report: TrackingReport, path: Path) -> None:
    """Four pictures in one."""
    figure = new_figure(13.0, 10.0)
    (jitter, lock), (tracks, spectra) = figure.subplots(2, 2)
    _figure_1(jitter, report)
    _lock(lock, report)
    _figure_8(tracks, report)
    _figure_9(spectra, report)
    for axes in (jitter, lock, tracks, spectra):
        axes.grid(visible=True, alpha=0.3)
        axes.legend(fontsize="x-small")
    save_figure(figure, path)


def _figure_1(axes: "Axes", report: TrackingReport) -> None:
    for number, level in enumerate(FAMILY_DBHZ):
        curve = [each for each in report.jitters if each.cn0_dbhz == level]
        bandwidths_hz = [each.bandwidth_hz for each in curve]
        colour, label = f"C{number}", f"{level:g} dB-Hz"
        axes.semilogy(bandwidths_hz, [each.inside_hz for each in curve], color=colour, label=label)
        axes.semilogy(bandwidths_hz, [each.outside_hz for each in curve], color=colour, ls=":")
    axes.axhline(threshold_hz(), color="0.4", lw=1.0)
    axes.set(
        title="figure 1: thermal jitter (dotted: bracket outside the root; grey: threshold)",
        xlabel="bandwidth, Hz",
        ylabel="one sigma, Hz",
    )


def _lock(axes: "Axes", report: TrackingReport) -> None:
    for number, loop in enumerate(report.loops):
        width, dashes = 2.5 if number < 2 else 1.0, ("-", "--")[number // 10]
        shares_pct = [100.0 * share for share in loop.lost.shares]
        label = f"{loop.name}, {loop.bandwidth_hz:.2g} Hz"
        axes.plot(loop.lost.cn0_dbhz, shares_pct, label=label, lw=width, ls=dashes)
    axes.axhline(50.0, color="0.4", lw=1.0)
    axes.set(title="lock lost", xlabel="C/N0, dB-Hz", ylabel="runs, %")


def _figure_8(axes: "Axes", report: TrackingReport) -> None:
    eight = report.figure_8
    times_s = np.arange(len(eight.doppler_hz)) * PAIR_S
    for track in eight.tracks:
        label = f"{track.name}, {track.bandwidth_hz:g} Hz"
        axes.plot(times_s[: len(track.tracked_hz)], track.tracked_hz, lw=0.8, label=label)
    axes.plot(times_s, eight.doppler_hz, color="0.2", lw=1.5, label="signal")
    axes.set(
        title=f"figure 8: a carrier at {eight.cn0_dbhz:g} dB-Hz, one run until lock is lost",
        xlabel="time, s",
        ylabel="Doppler, Hz",
    )


def _figure_9(axes: "Axes", report: TrackingReport) -> None:
    nine = report.figure_9
    for name, spectrum, colour in (
        ("told nothing", nine.without, "C2"),
        ("aided", nine.aided, "C0"),
    ):
        label = f"{name}, {spectrum.bandwidth_hz:.2g} Hz"
        densities_db = 10.0 * np.log10(np.array(spectrum.density_hz2_per_hz[1:]))
        axes.semilogx(spectrum.frequencies_hz[1:], densities_db, color=colour, label=label)
    axes.set(
        title=f"figure 9: offset at {nine.cn0_dbhz:g} dB-Hz, {nine.power_db:.1f} dB less power",
        xlabel="frequency, Hz",
        ylabel="density, dB over 1 Hz^2/Hz",
    )
