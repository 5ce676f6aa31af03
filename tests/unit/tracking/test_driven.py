"""Stretches of a drive under its own sky."""

import numpy as np
import pytest

from unit.evaluation.drives import SPEED_MPS, START_S, eastwards, off
from wayline.errors import InputError
from wayline_evaluation.estimates import Estimates
from wayline_evaluation.tracking.driven import Driven, Stretches, stretches_of
from wayline_evaluation.tracking.loop import SAMPLES_HZ
from wayline_evaluation.tracking.motion import WAVELENGTH_M, doppler_hz

EARLY_SKY, LATE_SKY = (START_S + 10.0, 30.0, 90.0), (START_S + 90.0, 60.0, 180.0)
"""One satellite ahead, in the east, later another one beside."""


def poses() -> Estimates:
    """To the east, sure of speed and heading to 1."""
    return off(eastwards(100.0))


def drawn(estimates: Estimates, seconds: float = 10.0, runs: int = 40) -> Stretches:
    driven = Driven("drive", estimates, [EARLY_SKY, LATE_SKY])
    random = np.random.default_rng(1)
    return stretches_of(driven, seconds, runs, clock_hz_per_sqrt_s=0.0, random=random)


def test_every_stretch_is_under_a_satellite_of_its_own_time() -> None:
    """The one ahead approaches at the speed's part along its ray, the one beside not at all."""
    motions = drawn(poses()).motions
    ahead = np.isclose(np.degrees(motions.azimuths_rad), 90.0)
    assert 0 < np.count_nonzero(ahead) < len(ahead)
    expected_hz = (SPEED_MPS - 0.5) * np.cos(np.radians(30.0)) / WAVELENGTH_M
    carriers_hz = doppler_hz(motions)
    assert carriers_hz.shape == (10 * SAMPLES_HZ, 40)
    assert carriers_hz[:, ahead] == pytest.approx(expected_hz, abs=0.1)
    assert carriers_hz[:, ~ahead] == pytest.approx(0.0, abs=0.1)


def test_the_poses_own_stds_are_told() -> None:
    stretches = drawn(poses())
    assert (stretches.speed_std_mps, stretches.heading_std_deg) == (1.0, 1.0)


def test_who_stands_has_no_stretch() -> None:
    still = poses()
    still.speeds_mps[:] = 0.1
    with pytest.raises(InputError, match="no 10 s of it without a hole are under way"):
        drawn(still)


def test_a_drive_shorter_than_a_stretch_is_refused_with_the_mend() -> None:
    with pytest.raises(InputError, match="give fewer --seconds"):
        drawn(poses(), seconds=120.0)


def test_a_hole_in_the_poses_is_in_no_stretch() -> None:
    whole = poses()
    whole.times_s[500:] += 20.0
    starts_s = START_S + 50.0
    begun_s = _begins_s(whole)
    assert not np.any((begun_s > starts_s - 10.0) & (begun_s < starts_s))


def _begins_s(estimates: Estimates) -> np.ndarray:
    """Told by a speed that is the time itself."""
    estimates.speeds_mps[:] = 10.0 + 0.01 * (estimates.times_s - START_S)
    first_mps = drawn(estimates).motions.speeds_mps[0]
    return np.asarray(START_S + 100.0 * (first_mps - 10.0))
