"""Pure: what papers/003 prints, for tables that set its figures beside."""

from typing import NamedTuple

from wayline_evaluation.smoothing.smoothers import Method


class Printed(NamedTuple):
    """One method's rows of tables 1, 3 and 4: miles an hour, a second, miles."""

    speed_mph: float
    bad_signal_speed_mph: float
    acceleration_mean_mph: float
    acceleration_variance: float
    acceleration_mae_mph: float
    distance_mean_mile: float
    distance_mae_mile: float
    chi2: float


PRINTED: dict[Method, Printed] = {
    "least_squares_spline": Printed(-0.50, 4.4, -0.00179, 1.9669, 0.77372, -97.414, 97.904, 249.38),
    "kernel": Printed(-0.49, 4.4, -0.00158, 1.6287, 0.69836, -56.604, 57.127, 236.04),
    "kalman": Printed(-0.49, 4.4, -0.00133, 1.4388, 0.63735, -52.919, 53.537, 231.91),
    "modified_kalman": Printed(-0.50, 4.0, -0.00047, 1.4173, 0.63222, 0.179, 0.192, 9.90),
}
"""1,702 trips of seven vehicles, 1,497,066 fixes; VSS minus method."""

PRINTED_P_VALUES: dict[tuple[Method, Method], tuple[float, float]] = {
    ("least_squares_spline", "kernel"): (0.0, 7.49e-15),
    ("least_squares_spline", "kalman"): (1.68e-28, 1.40e-13),
    ("kernel", "kalman"): (7.45e-156, 1.69e-50),
    ("least_squares_spline", "modified_kalman"): (2.08e-22, 3.19e-18),
    ("kernel", "modified_kalman"): (7.42e-172, 1.22e-59),
    ("kalman", "modified_kalman"): (0.22181, 0.22397),
}
"""Table 2: of mean errors of speed and of acceleration."""
