"""Pure: what the sensors of a drive said, as arrays: the input of the sensor study."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wayline.messages import GpsFix
from wayline_evaluation.estimates import Floats
from wayline_evaluation.plane import Grid
from wayline_evaluation.reference import Reference
from wayline_evaluation.sensed import Series
from wayline_evaluation.standstills import Span
from wayline_simulator.facts import Facts


@dataclass(frozen=True, slots=True)
class Epochs:
    """All that a receiver sent, in order of time, shape (n,); nan where unknown or not valid."""

    times_s: Floats
    """Unix."""
    valid: NDArray[np.bool_]
    east_m: Floats
    """On a flat grid about the drive's first valid fix."""
    north_m: Floats
    alts_m: Floats
    speeds_mps: Floats
    satellites: Floats
    hdops: Floats
    errors_m: Floats
    """East, north and up of the truth, shape (n, 3); nan without one."""
    speed_errors_mps: Floats
    """The fixes' speed minus the true one, shape (n,); nan without a truth. A speed has no sign."""


@dataclass(frozen=True, slots=True)
class SensorRecord:
    """One drive."""

    drive: str
    start_s: float
    """Smallest time of any message."""
    epochs: Epochs
    gyro: Series
    odometer: Series
    barometer: Series
    rests: tuple[Span, ...]
    """When the vehicle stood."""
    has_truth: bool
    facts: Facts | None
    """Of a simulated drive."""


def epochs_of(fixes: Sequence[GpsFix], truth: Reference | None) -> Epochs:
    """A receiver's fixes in order of time, as arrays."""

    def column(name: str) -> Floats:
        return np.array([getattr(fix, name) for fix in fixes], dtype=np.float64)

    valid = np.array([fix.valid for fix in fixes], dtype=np.bool_)

    def known(name: str) -> Floats:
        return np.where(valid, column(name), np.nan)

    times_s, lats_deg, lons_deg = column("t_ns") * 1e-9, known("lat_deg"), known("lon_deg")
    first = int(np.argmax(valid)) if valid.any() else None
    # without a valid fix there is nothing to lay on it
    grid = Grid(0.0, 0.0) if first is None else Grid(float(lats_deg[first]), float(lons_deg[first]))
    east_m, north_m = _on_grid(grid, lats_deg, lons_deg)
    alts_m = known("alt_m")
    speeds_mps = known("speed_mps")
    errors_m = np.full((len(times_s), 3), np.nan)
    speed_errors_mps = np.full(len(times_s), np.nan)
    if truth is not None:
        there = truth.at(times_s)
        true_east_m, true_north_m = _on_grid(grid, there.lats_deg, there.lons_deg)
        errors_m = np.column_stack(
            (east_m - true_east_m, north_m - true_north_m, alts_m - there.alts_m)
        )
        speed_errors_mps = speeds_mps - np.abs(there.speeds_mps)
    return Epochs(
        times_s=times_s,
        valid=valid,
        east_m=east_m,
        north_m=north_m,
        alts_m=alts_m,
        speeds_mps=speeds_mps,
        satellites=known("satellites"),
        hdops=known("hdop"),
        errors_m=errors_m,
        speed_errors_mps=speed_errors_mps,
    )


def _on_grid(grid: Grid, lats_deg: Floats, lons_deg: Floats) -> tuple[Floats, Floats]:
    """Unlike the projection, nan for nan."""
    known = ~np.isnan(lats_deg)
    east_m, north_m = np.full((2, len(lats_deg)), np.nan)
    east_m[known], north_m[known] = grid.to_grid(lats_deg[known], lons_deg[known])
    return east_m, north_m
