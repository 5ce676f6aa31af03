"""The batch of backward steps comes to what filterpy's smoother comes to."""

import numpy as np
import pytest
from filterpy.kalman import KalmanFilter

from wayline.tuning import Tuning
from wayline.vertical.filter import VerticalFilter
from wayline.vertical.smoother import rts


def test_a_run_is_smoothed_as_by_filterpy() -> None:
    kalman, rng = VerticalFilter(Tuning()), np.random.default_rng(5)
    steps = []
    for step in range(60):
        moved = [each.copy() for each in kalman.advance(4.0 + rng.random(), 0.2)]
        kalman.correct(kalman.model.gps_altitude(kalman.x, 0, 500.0 + 0.1 * step, 3.0))
        kalman.correct(kalman.model.barometer(kalman.x, 480.0 + rng.normal(), 0.5))
        steps.append((kalman.x, kalman.P, *moved))
    told = [np.array(each) for each in zip(*steps, strict=True)]
    library = KalmanFilter(dim_x=kalman.model.size, dim_z=1)
    means, covariances, _, _ = library.rts_smoother(told[0], told[1], Fs=told[2], Qs=told[3])
    our_means, our_covariances = rts(*told)
    assert our_means == pytest.approx(means, rel=1e-6, abs=1e-8)
    assert our_covariances == pytest.approx(covariances, rel=1e-5, abs=1e-8)
    assert np.abs(our_means[0] - told[0][0]).max() > 1e-3


def test_a_correction_is_filterpys() -> None:
    kalman, library = VerticalFilter(Tuning()), KalmanFilter(dim_x=10, dim_z=1)
    measurement = kalman.model.gps_altitude(kalman.x, 0, 512.0, 3.0)
    library.x, library.P = kalman.x.copy(), kalman.P.copy()
    library.update(512.0, measurement.R, measurement.H)
    kalman.correct(measurement)
    assert kalman.x == pytest.approx(library.x, rel=1e-9)
    assert pytest.approx(library.P, rel=1e-6, abs=1e-9) == kalman.P
