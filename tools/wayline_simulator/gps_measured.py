"""Pure: how far a receiver's positions and velocities are off the truth."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wayline_simulator.gps_errors import held, lagged, reflections
from wayline_simulator.gps_gaps import Awakenings, awakenings, errors_after
from wayline_simulator.gps_model import GpsModel
from wayline_simulator.journey import Floats, Truth
from wayline_simulator.noise import gauss_markov

Flags = NDArray[np.bool_]


class Effects(NamedTuple):
    """What surroundings do beyond hiding satellites; judgements."""

    reflection: float
    """Share of the reflections of a canyon."""
    position: float
    """Factor of the white error."""
    velocity: float
    """Doppler suffers far less than ranges."""


EFFECTS = np.array(
    [
        Effects(0.0, 1.0, 1.0),
        Effects(0.03, 1.5, 1.3),
        Effects(0.1, 2.0, 1.5),
        Effects(1.0, 5.0, 2.5),
        Effects(0.0, 1.0, 1.0),
        Effects(0.0, 1.0, 1.0),
        Effects(0.0, 1.0, 1.0),
    ]
)
"""A row for each of Surroundings."""
EDGE_TIME_S = 3.0
"""In which a receiver's filter follows new surroundings."""
REST_MPS = 0.1
"""Slower, a receiver takes itself as standing."""
ALTITUDE_FACTOR = 3.0
"""A first altitude is so much worse than a first position (css-164: 92 to 36 m)."""


def position_errors(
    truth: Truth, valid: Flags, dilutions: Floats, model: GpsModel, random: np.random.Generator
) -> tuple[Floats, Floats]:
    """Errors east, north and up of epochs, and the stds that the receiver believes in.

    `valid`: where it has a fix, shape (n,); the rest of shape (n, 3), `dilutions` for each axis.
    """
    count, step_s = len(valid), 1.0 / model.rate_hz
    effects = lagged(EFFECTS[truth.surroundings], step_s, EDGE_TIME_S)
    white_m = (
        dilutions * effects[:, 1:2] * _axes(model.position_white_std_m, model.altitude_white_std_m)
    )
    wander_m = dilutions * _axes(model.position_wander_std_m, model.altitude_wander_std_m)
    wander = np.column_stack(
        (
            gauss_markov((count, 2), step_s, 1.0, model.position_wander_time_s, random),
            gauss_markov(count, step_s, 1.0, model.altitude_wander_time_s, random),
        )
    )
    reflected = reflections(np.radians(truth.headings_deg), step_s, model.reflection_time_s, random)
    offsets_m = white_m * random.standard_normal((count, 3)) + wander_m * wander
    offsets_m += model.reflection_std_m * effects[:, 0:1] * reflected
    variances_m2 = white_m**2 + wander_m**2
    for first_m, time_s, woken in _beginnings(valid, model, step_s):
        scale_m = _axes(first_m, ALTITUDE_FACTOR * first_m)
        std, error = errors_after(woken, count, step_s, time_s, random)
        offsets_m += scale_m * error
        variances_m2 += (scale_m * std[:, np.newaxis]) ** 2
    stds_m = model.reported_std_factor * np.sqrt(variances_m2)
    return offsets_m, stds_m


def _axes(level: float, up: float) -> Floats:
    return np.array([level, level, up])


def _beginnings(
    valid: Flags, model: GpsModel, step_s: float
) -> tuple[tuple[float, float, Awakenings], ...]:
    """Std, decay and instants of errors that fade: of the cold start and of later awakenings."""
    cold = np.flatnonzero(valid)[:1] if model.first_fix_s > 0.0 else np.array([], dtype=np.intp)
    return (
        (model.first_error_m, model.first_error_time_s, Awakenings(cold, np.ones(len(cold)))),
        (model.reacquire_error_m, model.reacquire_error_time_s, awakenings(valid, step_s)),
    )


def smoothed_altitudes_m(
    alts_m: Floats, mode: NDArray[np.int8], model: GpsModel, step_s: float
) -> Floats:
    """Smoothed in every stretch with a 3-D fix; the last one of it stands in a 2-D fix."""
    known = mode == 3
    smooth_m = alts_m.copy()
    edges = np.flatnonzero(np.diff(known, prepend=False, append=False))
    for first, last in zip(edges[::2], edges[1::2], strict=True):
        smooth_m[first:last] = lagged(alts_m[first:last], step_s, model.smoothing_time_s)
    return held(smooth_m, known)


def measured_velocities(
    truth: Truth, hdop: Floats, model: GpsModel, random: np.random.Generator
) -> tuple[Floats, Floats]:
    """Speeds, and courses with nan where the receiver knows none."""
    true_mps = np.abs(truth.speeds_mps)
    moving_mps = model.velocity_std_mps * hdop * EFFECTS[truth.surroundings, 2]
    stds_mps = np.where(true_mps < REST_MPS, model.velocity_rest_std_mps, moving_mps)
    noise_mps = stds_mps[:, np.newaxis] * random.standard_normal((len(true_mps), 2))
    courses_rad = np.radians(truth.courses_deg)
    east_mps = true_mps * np.sin(courses_rad) + noise_mps[:, 0]
    north_mps = true_mps * np.cos(courses_rad) + noise_mps[:, 1]
    speeds_mps = np.hypot(east_mps, north_mps)
    courses_deg = np.degrees(np.arctan2(east_mps, north_mps)) % 360.0
    known = speeds_mps >= model.course_min_mps
    if model.course_at_rest == "held":
        return speeds_mps, held(courses_deg, known)
    return speeds_mps, np.where(known, courses_deg, np.nan)
