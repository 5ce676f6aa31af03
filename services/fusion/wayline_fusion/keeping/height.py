"""Pure: from the altitude that is believed to what is kept of it, and what is still good later."""

import math
from collections.abc import Mapping

import msgspec
import numpy as np

from wayline.tuning import Tuning
from wayline.vertical.loading import STOOD_S
from wayline.vertical.model import VerticalModel
from wayline.vertical.states import VerticalStates
from wayline_fusion.filter.vertical import Snapshot
from wayline_fusion.keeping.records import LastHeight, Saved, SensorCalibration

S = VerticalStates
STOOD_MPS = 0.5
"""Slower is standing."""
USEFUL_STD_M = 100.0
"""An altitude known worse is none to go on from."""


def kept_height(snapshot: Snapshot) -> LastHeight | None:
    """What is worth keeping of a state; None of one that knows no altitude, or lost its numbers."""
    kept = slice(S.CURVATURE)
    x, covariance = snapshot.x[kept], snapshot.P[kept, kept]
    if not snapshot.known or not math.isfinite(float(x.sum()) + float(covariance.sum())):
        return None
    alt_std_m, slope_std, bias_std_m = np.sqrt(np.maximum(np.diag(covariance), 0.0)).tolist()
    shared_m2 = float(covariance[S.ALTITUDE, S.BARO_BIAS])
    return LastHeight(
        alt_m=x.item(S.ALTITUDE),
        alt_std_m=alt_std_m,
        grade_pct=100.0 * x.item(S.SLOPE),
        grade_std_pct=100.0 * slope_std,
        baro_bias_m=x.item(S.BARO_BIAS),
        baro_bias_std_m=bias_std_m,
        alt_bias_correlation=shared_m2 / (alt_std_m * bias_std_m),
        inverse_mass=snapshot.x.item(S.INVERSE_MASS),
        inverse_mass_std=math.sqrt(max(snapshot.P.item(S.INVERSE_MASS, S.INVERSE_MASS), 0.0)),
    )


def resumed_height(
    saved: Saved, height: LastHeight, fresh: Snapshot, t_ns: int, tuning: Tuning
) -> Snapshot:
    """The state to start with at an instant, from a height that was kept with a pose.

    The vehicle stood, and may have been moved a little, or goes on as it drove: the model itself
    says what that does to altitude and slope, and the weather to the barometer's bias. A vehicle
    that stood for minutes may carry another load.
    """
    off_s = max(t_ns - saved.t_ns, 0) * 1e-9
    speed_mps = 0.0 if saved.pose is None else saved.pose.speed_mps
    x, covariance = _state(height, fresh)
    model = VerticalModel(tuning, len(x) - S.GPS_ERROR)
    if abs(speed_mps) < STOOD_MPS:
        moved = model.transition(0.0, off_s)
        moved_m = tuning.parked_position_std_m * tuning.slope_initial_std_pct / 100.0
        moved.Q[S.ALTITUDE, S.ALTITUDE] += moved_m**2
    else:
        moved = model.transition(speed_mps * off_s, off_s)
    if abs(speed_mps) < STOOD_MPS and off_s >= STOOD_S:
        moved.Q[S.INVERSE_MASS, S.INVERSE_MASS] = model.load_std**2
    x, covariance = moved.F @ x, moved.F @ covariance @ moved.F.T + moved.Q
    if covariance[S.ALTITUDE, S.ALTITUDE] > USEFUL_STD_M**2:
        return fresh
    return msgspec.structs.replace(fresh, t_ns=t_ns, known=True, x=x, P=covariance)


def with_noise(known: SensorCalibration, factors: Mapping[str, float]) -> SensorCalibration:
    """With how noisy the sensors of the height were found to be."""
    return msgspec.structs.replace(
        known,
        pressure_noise_factor=factors["barometer"],
        torque_noise_factor=factors["torque"],
        vehicle_slope_noise_factor=factors["vehicle_slope"],
    )


def noise_of(known: SensorCalibration) -> dict[str, float]:
    """How noisy the sensors of the height were found to be, as `with_noise` takes it."""
    return {
        "barometer": known.pressure_noise_factor,
        "torque": known.torque_noise_factor,
        "vehicle_slope": known.vehicle_slope_noise_factor,
    }


def _state(height: LastHeight, fresh: Snapshot) -> tuple[np.ndarray, np.ndarray]:
    x, covariance = fresh.x.copy(), fresh.P.copy()
    x[: S.CURVATURE] = height.alt_m, height.grade_pct / 100.0, height.baro_bias_m
    stds = height.alt_std_m, height.grade_std_pct / 100.0, height.baro_bias_std_m
    covariance[: S.CURVATURE, : S.CURVATURE] = np.diag(np.square(stds))
    shared_m2 = height.alt_bias_correlation * height.alt_std_m * height.baro_bias_std_m
    covariance[S.ALTITUDE, S.BARO_BIAS] = covariance[S.BARO_BIAS, S.ALTITUDE] = shared_m2
    if height.inverse_mass is not None and height.inverse_mass_std is not None:
        x[S.INVERSE_MASS] = height.inverse_mass
        covariance[S.INVERSE_MASS, S.INVERSE_MASS] = height.inverse_mass_std**2
    return x, covariance
