"""Pure: figures of a vehicle's own sensors: gyro, wheels, air pressure."""

from collections.abc import Sequence

import msgspec
import numpy as np
from scipy.stats import median_abs_deviation

from wayline_evaluation.estimates import Floats
from wayline_evaluation.sensed import Series
from wayline_evaluation.sensor_record import SensorRecord
from wayline_evaluation.sensor_series import (
    AllanPoint,
    allan_of,
    lag_1_of,
    rate_of,
    roughness_of,
    spread_of,
    step_of,
)
from wayline_evaluation.standstills import within

COMPARED_MPS = 5.0
"""Faster, speeds of wheels and Doppler are compared."""


class GyroFigures(msgspec.Struct, frozen=True, kw_only=True):
    """At rest, but for rate and step."""

    rate_hz: float
    step_degps: float | None
    rests: int
    rest_s: float
    bias_degps: float | None
    std_degps: float | None
    """About each standstill's own mean."""
    lag_1_autocorrelation: float | None
    allan: tuple[AllanPoint, ...]


class OdometerFigures(msgspec.Struct, frozen=True, kw_only=True):
    """Of neighbouring samples, both of a moving vehicle."""

    rate_hz: float
    step_mps: float | None
    slowest_mps: float | None
    """The lowest speed besides 0."""
    unchanged_share: float | None
    one_step_share: float | None
    change_rms_mps: float | None
    gps_over_wheels: float | None
    """Median ratio of the receiver's speed to the wheels'."""
    gps_residual_mps: float | None
    """Spread (1.48 median deviations) of what the ratio leaves."""


class BarometerFigures(msgspec.Struct, frozen=True, kw_only=True):
    """Of neighbouring samples."""

    rate_hz: float
    step_pa: float | None
    unchanged_share: float
    change_rms_pa: float
    rest_std_pa: float | None
    """About each standstill's own mean."""
    roughness_pa: float | None
    """The white noise that third differences amount to; 0 where most samples stay the same."""


def gyro_figures(records: Sequence[SensorRecord]) -> GyroFigures | None:
    """Pooled over drives; None where none has a gyro."""
    given = _given([record.gyro for record in records])
    if not given:
        return None
    pieces = rest_rates_degps(records)
    rate_hz = rate_of(series.times_s for series in given)
    rates_degps = np.concatenate([np.empty(0), *pieces])
    return GyroFigures(
        rate_hz=rate_hz,
        step_degps=step_of(np.concatenate([series.values for series in given])),
        rests=len(pieces),
        rest_s=len(rates_degps) / rate_hz,
        bias_degps=float(rates_degps.mean()) if pieces else None,
        std_degps=spread_of(pieces) if pieces else None,
        lag_1_autocorrelation=lag_1_of(pieces),
        allan=allan_of(pieces, rate_hz) if pieces else (),
    )


def rest_rates_degps(records: Sequence[SensorRecord]) -> list[Floats]:
    """One piece a standstill, at least three samples each."""
    return [
        piece
        for record in records
        for piece in within(record.gyro.times_s, record.gyro.values, record.rests)
        if len(piece) >= 3
    ]


def odometer_figures(records: Sequence[SensorRecord]) -> OdometerFigures | None:
    """Pooled over drives; None where none tells its wheels' speed."""
    given = _given([record.odometer for record in records])
    if not given:
        return None
    speeds_mps = np.abs(np.concatenate([series.values for series in given]))
    changes_mps = np.abs(np.concatenate([_moving_changes_mps(series) for series in given]))
    step_mps = step_of(speeds_mps)
    steps = changes_mps / step_mps if step_mps else np.empty(0)
    ratio, residual_mps = _against_gps(records)
    return OdometerFigures(
        rate_hz=rate_of(series.times_s for series in given),
        step_mps=step_mps,
        slowest_mps=float(speeds_mps[speeds_mps > 0.0].min()) if speeds_mps.any() else None,
        unchanged_share=float(np.mean(steps < 0.5)) if len(steps) else None,
        one_step_share=float(np.mean((steps >= 0.5) & (steps < 1.5))) if len(steps) else None,
        change_rms_mps=float(np.sqrt(np.mean(changes_mps**2))) if len(steps) else None,
        gps_over_wheels=ratio,
        gps_residual_mps=residual_mps,
    )


def barometer_figures(records: Sequence[SensorRecord]) -> BarometerFigures | None:
    """Pooled over drives; None where none has a barometer."""
    given = _given([record.barometer for record in records])
    if not given:
        return None
    changes_pa = np.concatenate([np.diff(series.values) for series in given])
    pieces = [
        piece
        for record in records
        for piece in within(record.barometer.times_s, record.barometer.values, record.rests)
        if len(piece) >= 3
    ]
    return BarometerFigures(
        rate_hz=rate_of(series.times_s for series in given),
        step_pa=step_of(np.concatenate([series.values for series in given])),
        unchanged_share=float(np.mean(changes_pa == 0.0)),
        change_rms_pa=float(np.sqrt(np.mean(changes_pa**2))),
        rest_std_pa=spread_of(pieces) if pieces else None,
        roughness_pa=roughness_of(np.concatenate([np.diff(series.values, 3) for series in given])),
    )


def _given(series: Sequence[Series]) -> list[Series]:
    return [each for each in series if len(each) > 1]


def _moving_changes_mps(series: Series) -> Floats:
    moves = series.values != 0.0
    changes_mps: Floats = np.diff(series.values)[moves[1:] & moves[:-1]]
    return changes_mps


def _against_gps(records: Sequence[SensorRecord]) -> tuple[float | None, float | None]:
    """Ratio and residual of receivers' speeds to wheels'; None without either."""
    gps_mps, wheels_mps = np.empty(0), np.empty(0)
    for record in records:
        if len(record.odometer) > 1 and len(record.epochs.times_s):
            wheels = np.interp(
                record.epochs.times_s,
                record.odometer.times_s,
                np.abs(record.odometer.values),
                left=np.nan,
                right=np.nan,
            )
            fast = (record.epochs.speeds_mps > COMPARED_MPS) & (wheels > COMPARED_MPS)
            gps_mps = np.append(gps_mps, record.epochs.speeds_mps[fast])
            wheels_mps = np.append(wheels_mps, wheels[fast])
    if not len(gps_mps):
        return None, None
    ratio = float(np.median(gps_mps / wheels_mps))
    return ratio, float(median_abs_deviation(gps_mps - ratio * wheels_mps, scale="normal"))
