"""The sensor study as a table for people: a row a figure, a column a drive."""

from collections.abc import Iterator, Sequence

import numpy as np
from rich.table import Table

from wayline_evaluation.sensor_gps import LAGS_S, Correlation, GpsFigures
from wayline_evaluation.sensor_series import AllanPoint, Quantiles
from wayline_evaluation.sensor_study import Group, SensorReport
from wayline_evaluation.sensor_vehicle import BarometerFigures, GyroFigures, OdometerFigures

TAUS_S = (0.1, 1.0, 10.0, 100.0)
Rows = dict[str, str]


def sensor_tables(report: SensorReport, groups: Sequence[Group]) -> Iterator[Table]:
    """One a sensor that any drive has."""
    titles = [group.title for group in groups]
    gps = [_gps_rows(column.gps) for column in report.columns]
    gyro = [_gyro_rows(column.gyro) for column in report.columns]
    odometer = [_odometer_rows(column.odometer) for column in report.columns]
    barometer = [_barometer_rows(column.barometer) for column in report.columns]
    for name, columns in (
        ("GPS", gps),
        ("gyro", gyro),
        ("odometer", odometer),
        ("barometer", barometer),
    ):
        if any(columns):
            yield _table(name, titles, columns)


def _table(name: str, titles: Sequence[str], columns: Sequence[Rows]) -> Table:
    table = Table(title=name, title_justify="left", header_style="bold", box=None, pad_edge=False)
    table.add_column("", no_wrap=True)
    for title in titles:
        table.add_column(title, justify="right")
    for row in dict.fromkeys(row for column in columns for row in column):
        table.add_row(row, *(column.get(row, "") for column in columns))
    return table


def _gps_rows(figures: GpsFigures | None) -> Rows:
    if figures is None:
        return {}
    rows = {
        "epochs": f"{figures.epochs}",
        "rate, Hz": _number(figures.rate_hz, 2),
        "until the first fix, s": _number(figures.first_fix_s, 0),
        "not valid after it, %": _percent(figures.invalid_share),
        "holes": f"{figures.holes}",
        "longest hole, s": _number(figures.longest_hole_s, 1),
        "satellites used, p5 / p50 / p95": _quantiles(figures.satellites, 0),
        "HDOP, p5 / p50 / p95": _quantiles(figures.hdop, 2),
        "speed at rest, p5 / p50 / p95, m/s": _quantiles(figures.rest_speed_mps, 3),
        "drift in 10 s of rest, p5 / p50 / p95, m": _quantiles(figures.rest_drift_m, 2),
        "such times of rest": f"{figures.rest_windows}",
        "roughness across the track, m": _number(figures.across_roughness_m, 3),
        "roughness of altitude, m": _number(figures.alt_roughness_m, 3),
        "roughness of speed, m/s": _number(figures.speed_roughness_mps, 3),
    }
    if errors := figures.errors:
        rows |= {
            "error east / north, rms, m": f"{errors.east_rms_m:.2f} / {errors.north_rms_m:.2f}",
            "error up, rms, m": _number(errors.up_rms_m, 2),
            "error of speed, rms, m/s": _number(errors.speed_rms_mps, 3),
            "horizontal error, p5 / p50 / p95, m": _quantiles(errors.horizontal_m, 2),
        }
        rows |= _correlation_rows(errors.autocorrelation)
    return _known(rows)


def _correlation_rows(points: Sequence[Correlation]) -> Rows:
    lags = {point.lag_s: point for point in points}
    return {
        f"autocorrelation at {lag_s} s, level / up": (
            f"{_number(lags[lag_s].horizontal, 2)} / {_number(lags[lag_s].up, 2)}"
        )
        for lag_s in LAGS_S
        if lag_s in lags
    }


def _gyro_rows(figures: GyroFigures | None) -> Rows:
    if figures is None:
        return {}
    rows = {
        "rate, Hz": _number(figures.rate_hz, 1),
        "step, deg/s": _number(figures.step_degps, 4),
        "standstills": f"{figures.rests}",
        "at rest, s": _number(figures.rest_s, 0),
        "mean at rest, deg/s": _number(figures.bias_degps, 3),
        "std at rest, deg/s": _number(figures.std_degps, 4),
        "lag-1 autocorrelation at rest": _number(figures.lag_1_autocorrelation, 2),
    }
    return _known(rows | _allan_rows(figures.allan))


def _allan_rows(points: Sequence[AllanPoint]) -> Rows:
    """Between two points, eight a decade, the curve is taken as straight."""
    taus = np.log([point.tau_s for point in points])
    deviations_degps = [point.deviation_degps for point in points]
    return {
        f"Allan deviation at {tau_s:g} s, deg/s": _number(
            float(np.interp(np.log(tau_s), taus, deviations_degps)), 4
        )
        for tau_s in TAUS_S
        if points and points[0].tau_s <= tau_s <= points[-1].tau_s
    }


def _odometer_rows(figures: OdometerFigures | None) -> Rows:
    if figures is None:
        return {}
    return _known(
        {
            "rate, Hz": _number(figures.rate_hz, 1),
            "step, m/s": _number(figures.step_mps, 4),
            "slowest, m/s": _number(figures.slowest_mps, 2),
            "unchanged from sample to sample, %": _percent(figures.unchanged_share),
            "changed by one step, %": _percent(figures.one_step_share),
            "change, rms, m/s": _number(figures.change_rms_mps, 3),
            "GPS speed over wheels'": _number(figures.gps_over_wheels, 4),
            "spread of what that leaves, m/s": _number(figures.gps_residual_mps, 3),
        }
    )


def _barometer_rows(figures: BarometerFigures | None) -> Rows:
    if figures is None:
        return {}
    return _known(
        {
            "rate, Hz": _number(figures.rate_hz, 2),
            "step, Pa": _number(figures.step_pa, 2),
            "unchanged from sample to sample, %": _percent(figures.unchanged_share),
            "change, rms, Pa": _number(figures.change_rms_pa, 1),
            "std at rest, Pa": _number(figures.rest_std_pa, 1),
            "roughness, Pa": _number(figures.roughness_pa, 1),
        }
    )


def _known(rows: Rows) -> Rows:
    return {name: text for name, text in rows.items() if text}


def _number(value: float | None, decimals: int) -> str:
    return "" if value is None else f"{value:.{decimals}f}"


def _percent(share: float | None) -> str:
    return "" if share is None else f"{100.0 * share:.1f}"


def _quantiles(values: Quantiles | None, decimals: int) -> str:
    if values is None:
        return ""
    return " / ".join(f"{each:.{decimals}f}" for each in (values.p5, values.p50, values.p95))
