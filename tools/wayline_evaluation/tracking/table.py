"""Pure: the study as tables, what papers/001 prints beside in brackets."""

from collections.abc import Iterator

from rich.table import Table

from wayline_evaluation.drive_table import drive_table, number, percent
from wayline_evaluation.tracking.figures import EXAMPLE_DBHZ, EXAMPLE_HZ, FAMILY_DBHZ
from wayline_evaluation.tracking.fll import ratio_hz, thermal_jitter_hz, threshold_hz
from wayline_evaluation.tracking.printed import ACQUISITION_DB, TRACKING_DB
from wayline_evaluation.tracking.report import TrackingReport

SHOWN_HZ = (0.1, 0.2, 0.4, 0.6, 0.8, 1.0, 1.2, 1.6, 2.0)
"""Bandwidths of figure 1 that a table has room for."""


def tracking_tables(report: TrackingReport) -> Iterator[Table]:
    """What is assumed, the equations, tracking, figures 8 and 9, acquisition."""
    yield _assumptions(report)
    yield _equation_2(report)
    yield _loops(report)
    yield _figures(report)
    yield _acquisition(report)


def _assumptions(report: TrackingReport) -> Table:
    motion = "random motion" if report.drive is None else f"motion and sky of {report.drive}"
    table = Table(title=f"assumed ({motion})", title_justify="left", box=None, pad_edge=False)
    table.add_column("")
    table.add_column("")
    for about, words in report.assumptions.items():
        if report.drive is None or about != "random motion":
            table.add_row(about, words)
    return table


def _equation_2(report: TrackingReport) -> Table:
    example = report.example_hz
    title = (
        f"figure 1: thermal jitter, Hz, T 0.01 s, F 1, threshold {threshold_hz():.2f} Hz; "
        f"{EXAMPLE_HZ:g} Hz at {EXAMPLE_DBHZ:g} dB-Hz: {example['inside']:.4f}, "
        f"with the bracket outside the root {example['outside']:.4f}"
    )
    table = drive_table(title, [f"{level:g} dB-Hz" for level in FAMILY_DBHZ], ("bandwidth, Hz",))
    known = {(each.bandwidth_hz, each.cn0_dbhz): each.inside_hz for each in report.jitters}
    for bandwidth_hz in SHOWN_HZ:
        jitters = (known[bandwidth_hz, level] for level in FAMILY_DBHZ)
        table.add_row(f"{bandwidth_hz:g}", *(f"{jitter:.3f}" for jitter in jitters))
    return table


def _loops(report: TrackingReport) -> Table:
    dynamics = report.dynamics
    title = (
        f"tracking: jerk {dynamics.jerk_hzps2:.2f} Hz/s2 (three sigma), of which the aid leaves "
        f"{dynamics.left_by_aid_hzps2:.2f}; its error {dynamics.aid_error_hz:.2f} Hz, claimed "
        f"{dynamics.aid_std_hz:.2f} (papers/001: {TRACKING_DB:g} dB)"
    )
    columns = (
        "bandwidth\nHz",
        "stress\nHz",
        "equation 1\ndB-Hz",
        "half lost\ndB-Hz",
        "+/-\ndB",
        "gained\ndB",
    )
    table = drive_table(title, columns, ("loop",))
    for loop in report.loops:
        table.add_row(
            loop.name,
            number(loop.bandwidth_hz, 2),
            number(loop.stress_hz, 2),
            number(loop.threshold_dbhz),
            number(loop.lost.half_dbhz),
            number(loop.lost.half_std_db),
            number(loop.gained_db),
        )
    return table


def _figures(report: TrackingReport) -> Table:
    eight, nine = report.figure_8, report.figure_9
    title = f"figure 8, at {eight.cn0_dbhz:g} dB-Hz, and figure 9, at {nine.cn0_dbhz:g} dB-Hz"
    columns = (
        "bandwidth\nHz",
        "equation 2\nHz",
        "offset rms\nHz",
        "lost\n%",
        "locked\ns",
        "less\ndB",
    )
    table = drive_table(title, columns, ("figure", "loop"))
    for track in eight.tracks:
        table.add_row(
            "8",
            track.name,
            number(track.bandwidth_hz, 2),
            number(track.jitter_hz),
            number(track.error_rms_hz),
            percent(track.lost_share, 0),
            number(track.locked_s),
        )
    for name, spectrum in (("told nothing", nine.without), ("aided", nine.aided)):
        jitter_hz = thermal_jitter_hz(spectrum.bandwidth_hz, ratio_hz(nine.cn0_dbhz))
        offset_hz = spectrum.power_hz2**0.5
        less_db = None if spectrum is nine.without else nine.power_db
        table.add_row(
            "9",
            name,
            number(spectrum.bandwidth_hz, 2),
            number(jitter_hz, 2),
            number(offset_hz, 2),
            "",
            "",
            number(less_db),
        )
    return table


def _acquisition(report: TrackingReport) -> Table:
    title = f"acquisition (papers/001: {ACQUISITION_DB:g} dB)"
    columns = (
        "to either\nside, Hz",
        "cells",
        "false alarm\na cell",
        "threshold",
        "found\ndB-Hz",
        "search\ns",
        "aid gains\ndB",
        "by cells\nalone, dB",
        "in the same\ntime, dB",
    )
    table = drive_table(title, columns, ("search",))
    for row in report.acquisition:
        searched = row.search
        table.add_row(
            searched.name,
            f"{searched.half_range_hz:.1f}",
            f"{searched.cells:,}",
            f"{searched.false_alarm_a_cell:.1e}",
            f"{searched.threshold:.1f}",
            number(searched.needed_dbhz),
            f"{searched.seconds:,.0f}",
            number(row.gained_db),
            number(row.gained_by_cells_db),
            number(row.gained_same_time_db),
        )
    return table
