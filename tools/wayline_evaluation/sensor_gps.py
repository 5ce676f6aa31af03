"""Pure: figures of a receiver, with a truth and without."""

from collections.abc import Iterator, Sequence

import msgspec
import numpy as np

from wayline_evaluation.estimates import Floats
from wayline_evaluation.sensor_record import Epochs, SensorRecord
from wayline_evaluation.sensor_series import (
    Quantiles,
    quantiles_of,
    rate_of,
    roughness_of,
    spread_of,
)
from wayline_evaluation.standstills import windows, within

LAGS_S = (1, 3, 10, 30, 100, 300)
DRIFT_WINDOW_S = 10.0
"""The shortest of css-164's two standstills with fixes has room for one."""
HOLE = 1.5
"""Longer than so many intervals of the receiver, something is missing."""
EVEN_SHARE = 0.1
"""Third differences are of four fixes whose intervals differ by no more than this from usual."""
MOVING_MPS = 3.0
"""Slower, a track has no clear direction."""


class Correlation(msgspec.Struct, frozen=True, kw_only=True):
    """How much of an error is still there after a time."""

    lag_s: float
    horizontal: float | None
    """Mean of both axes."""
    up: float | None


class GpsErrors(msgspec.Struct, frozen=True, kw_only=True):
    """Against the truth; root mean squares, for the truth is where errors should centre."""

    east_rms_m: float
    north_rms_m: float
    up_rms_m: float
    speed_rms_mps: float | None
    """Null where the receiver tells no speed."""
    horizontal_m: Quantiles | None
    autocorrelation: tuple[Correlation, ...]


class GpsFigures(msgspec.Struct, frozen=True, kw_only=True):
    """Null where there is nothing to judge by."""

    epochs: int
    rate_hz: float
    first_fix_s: float | None
    """From the drive's first message of any sensor; the mean of several drives."""
    invalid_share: float | None
    """Of what came after the first fix."""
    holes: int
    """Between fixes, longer than 1.5 usual intervals."""
    longest_hole_s: float | None
    satellites: Quantiles | None
    hdop: Quantiles | None
    rest_speed_mps: Quantiles | None
    rest_windows: int
    rest_drift_m: Quantiles | None
    """Std of an axis about the mean of 10 s of standing, over the windows."""
    across_roughness_m: float | None
    """The white noise that the track's third differences across its direction amount to."""
    alt_roughness_m: float | None
    speed_roughness_mps: float | None
    errors: GpsErrors | None


def gps_figures(records: Sequence[SensorRecord]) -> GpsFigures | None:
    """Pooled over drives; None where none has a receiver."""
    drives = [record for record in records if len(record.epochs.times_s) > 1]
    if not drives:
        return None
    epochs = [record.epochs for record in drives]
    holes_s = np.concatenate([_holes_s(each) for each in epochs])
    found = [drive for drive in drives if drive.epochs.valid.any()]
    since = [each.valid[int(np.argmax(each.valid)) :] for each in epochs if each.valid.any()]
    drifts = list(rest_tracks_m(drives, DRIFT_WINDOW_S))
    return GpsFigures(
        epochs=sum(len(each.times_s) for each in epochs),
        rate_hz=rate_of(each.times_s for each in epochs),
        first_fix_s=float(np.mean([_first_fix_s(drive) for drive in found])) if found else None,
        invalid_share=float(1.0 - np.mean(np.concatenate(since))) if since else None,
        holes=len(holes_s),
        longest_hole_s=float(holes_s.max()) if len(holes_s) else None,
        satellites=quantiles_of(np.concatenate([each.satellites for each in epochs])),
        hdop=quantiles_of(np.concatenate([each.hdops for each in epochs])),
        rest_speed_mps=quantiles_of(_rest_speeds_mps(drives)),
        rest_windows=len(drifts),
        rest_drift_m=quantiles_of(np.array([spread_of(list(track.T)) for track in drifts])),
        across_roughness_m=roughness_of(np.concatenate([_across_m(each) for each in epochs])),
        alt_roughness_m=roughness_of(_thirds(epochs, "alts_m")),
        speed_roughness_mps=roughness_of(_thirds(epochs, "speeds_mps")),
        errors=_errors([drive for drive in drives if drive.has_truth]),
    )


def rest_tracks_m(records: Sequence[SensorRecord], length_s: float) -> Iterator[Floats]:
    """East and north of the valid fixes in windows of standing, shape (n, 2), at least three."""
    for record in records:
        epochs = record.epochs
        places_m = np.column_stack((epochs.east_m, epochs.north_m))[epochs.valid]
        spans = list(windows(record.rests, length_s))
        for track in within(epochs.times_s[epochs.valid], places_m, spans):
            if len(track) >= 3:
                yield track


def autocorrelation(series: Sequence[Floats], lag: int) -> float | None:
    """Of errors about zero at even steps, pooled; nan is left out. None where nothing is known."""
    pairs = np.concatenate([piece[lag:] * piece[: len(piece) - lag] for piece in series])
    power = float(np.nanmean(np.concatenate(series) ** 2))
    if np.isnan(pairs).all() or power == 0.0:
        return None
    return float(np.nanmean(pairs)) / power


def even_errors_m(epochs: Epochs) -> Floats:
    """Errors on the receiver's own even grid of time, shape (n, 3), nan where a fix is missing."""
    step_s = _interval_s(epochs)
    rows = np.round((epochs.times_s - epochs.times_s[0]) / step_s).astype(np.intp)
    errors_m = np.full((int(rows[-1]) + 1, 3), np.nan)
    errors_m[rows] = epochs.errors_m
    return errors_m


def correlation_curve(
    records: Sequence[SensorRecord], lags_s: Sequence[float]
) -> tuple[Correlation, ...]:
    """Correlation of the errors of the drives that have a truth; their rates must be one."""
    epochs = [record.epochs for record in records if record.has_truth and record.epochs.valid.any()]
    errors_m = [even_errors_m(each) for each in epochs]
    step_s = _interval_s(epochs[0]) if epochs else 1.0
    longest_s = max((len(each) for each in errors_m), default=0) * step_s / 3.0
    return tuple(
        _correlation(errors_m, lag_s, round(lag_s / step_s))
        for lag_s in lags_s
        if lag_s <= longest_s
    )


def _correlation(errors_m: Sequence[Floats], lag_s: float, lag: int) -> Correlation:
    long = [each for each in errors_m if len(each) > lag]
    level = [each[:, axis] for each in long for axis in (0, 1)]
    return Correlation(
        lag_s=lag_s,
        horizontal=autocorrelation(level, lag),
        up=autocorrelation([each[:, 2] for each in long], lag),
    )


def _errors(records: Sequence[SensorRecord]) -> GpsErrors | None:
    errors_m = np.concatenate([np.empty((0, 3)), *(each.epochs.errors_m for each in records)])
    errors_m = errors_m[~np.isnan(errors_m).any(axis=1)]
    if not len(errors_m):
        return None
    east_m, north_m, up_m = (float(rms) for rms in np.sqrt(np.mean(errors_m**2, axis=0)))
    return GpsErrors(
        east_rms_m=east_m,
        north_rms_m=north_m,
        up_rms_m=up_m,
        speed_rms_mps=_speed_rms_mps(records),
        horizontal_m=quantiles_of(np.hypot(errors_m[:, 0], errors_m[:, 1])),
        autocorrelation=correlation_curve(records, LAGS_S),
    )


def _speed_rms_mps(records: Sequence[SensorRecord]) -> float | None:
    errors_mps = np.concatenate([each.epochs.speed_errors_mps for each in records])
    errors_mps = errors_mps[~np.isnan(errors_mps)]
    return float(np.sqrt(np.mean(errors_mps**2))) if len(errors_mps) else None


def _interval_s(epochs: Epochs) -> float:
    return float(np.median(np.diff(epochs.times_s)))


def _first_fix_s(record: SensorRecord) -> float:
    first = int(np.argmax(record.epochs.valid))
    return float(record.epochs.times_s[first]) - record.start_s


def _holes_s(epochs: Epochs) -> Floats:
    between_s: Floats = np.diff(epochs.times_s[epochs.valid])
    return between_s[between_s > HOLE * _interval_s(epochs)]


def _rest_speeds_mps(records: Sequence[SensorRecord]) -> Floats:
    pieces = [
        piece
        for record in records
        for piece in within(record.epochs.times_s, record.epochs.speeds_mps, record.rests)
    ]
    return np.concatenate([np.empty(0), *pieces])


def _moving(epochs: Epochs) -> Floats:
    """1 for four fixes in even intervals that move, else nan."""
    usual_s = _interval_s(epochs)
    even = np.abs(np.diff(epochs.times_s) - usual_s) <= EVEN_SHARE * usual_s
    together = even[2:] & even[1:-1] & even[:-2]
    moves = epochs.speeds_mps >= MOVING_MPS
    return np.where(together & moves[3:] & moves[:-3], 1.0, np.nan)


def _thirds(epochs: Sequence[Epochs], name: str) -> Floats:
    differences = [
        np.diff(getattr(each, name), 3) * _moving(each) for each in epochs if len(each.times_s) > 3
    ]
    return np.concatenate([np.empty(0), *differences])


def _across_m(epochs: Epochs) -> Floats:
    """Along the track, jerk and the jitter of timestamps would count."""
    if len(epochs.times_s) <= 3:
        return np.empty(0)
    east_m, north_m = epochs.east_m, epochs.north_m
    way_e, way_n = east_m[3:] - east_m[:-3], north_m[3:] - north_m[:-3]
    turned = np.diff(east_m, 3) * way_n - np.diff(north_m, 3) * way_e
    length_m = np.hypot(way_e, way_n)
    with np.errstate(invalid="ignore", divide="ignore"):
        across_m: Floats = turned / length_m * _moving(epochs)
    return across_m
