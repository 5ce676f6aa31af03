import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from wayline.messages import Pose
from wayline_dashboard.ellipse import ellipse_of, standard_ellipse


def test_a_north_south_error_points_north() -> None:
    ellipse = standard_ellipse(1.0, 3.0, 0.0)
    assert (ellipse.semi_major_m, ellipse.semi_minor_m) == pytest.approx((3.0, 1.0))
    assert ellipse.orientation_deg == pytest.approx(0.0)


def test_an_east_west_error_points_east() -> None:
    assert standard_ellipse(3.0, 1.0, 0.0).orientation_deg == pytest.approx(90.0)


def test_a_positive_covariance_leans_to_the_north_east() -> None:
    assert standard_ellipse(2.0, 2.0, 1.0).orientation_deg == pytest.approx(45.0)


@given(st.floats(0.1, 100.0), st.floats(0.1, 100.0), st.floats(-0.99, 0.99))
def test_the_axes_are_the_eigenvalues(east_m: float, north_m: float, correlation: float) -> None:
    cov_m2 = correlation * east_m * north_m
    ellipse = standard_ellipse(east_m, north_m, cov_m2)
    covariance = np.array([[east_m**2, cov_m2], [cov_m2, north_m**2]])
    minor_m2, major_m2 = np.linalg.eigvalsh(covariance)
    assert ellipse.semi_major_m == pytest.approx(math.sqrt(major_m2), rel=1e-6)
    assert ellipse.semi_minor_m == pytest.approx(math.sqrt(minor_m2), rel=1e-4)
    angle_rad = math.radians(ellipse.orientation_deg)
    along = np.array([math.sin(angle_rad), math.cos(angle_rad)])
    assert along @ covariance @ along == pytest.approx(major_m2, rel=1e-6)


def test_a_pose_without_stds_claims_no_ellipse() -> None:
    assert ellipse_of(Pose(t_ns=0, mode="starting")) is None
