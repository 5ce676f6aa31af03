"""What fusion's core is measured against: filterpy with nothing happening around it."""

import numpy as np
from filterpy.kalman import ExtendedKalmanFilter

from wayline.tuning import Tuning
from wayline.vertical.filter import VerticalFilter
from wayline_fusion.filter.horizontal import HorizontalFilter
from wayline_fusion.filter.states import SIZE, States


class BareFilter:
    """As many states as fusion's filter, constant matrices, a measurement of one number."""

    def __init__(self, size: int = SIZE) -> None:
        self._filter = kalman = ExtendedKalmanFilter(dim_x=size, dim_z=1)
        kalman.x = np.zeros(size)
        kalman.F = np.eye(size)
        kalman.F[States.EAST, States.WHEEL_SPEED] = 0.1
        kalman.Q = 1e-3 * np.eye(size)
        self._H = np.zeros((1, size))
        self._H[0, States.WHEEL_SPEED] = 1.0
        self._z = np.array([0.5])

    def steps(self, count: int, updates: int) -> None:
        """Run `count` predictions, each followed by `updates` updates."""
        for _ in range(count):
            self._filter.predict()
            for _ in range(updates):
                self._filter.update(self._z, self._jacobian, self._expected)

    @property
    def measured(self) -> float:
        """The state that the measurements are of."""
        return float(self._filter.x[States.WHEEL_SPEED])

    def _jacobian(self, _: object) -> np.ndarray:
        return self._H

    def _expected(self, x: np.ndarray) -> np.ndarray:
        expected: np.ndarray = self._H @ x
        return expected


class AlgebraAlone:
    """What fusion's step asks of filterpy, and nothing around it: no models, gates or messages."""

    def __init__(self) -> None:
        self._filter = HorizontalFilter(Tuning())
        self._altitude = VerticalFilter(Tuning())
        self._H = np.zeros((1, self._filter.dim_x))
        self._H[0, States.WHEEL_SPEED] = 1.0
        self._z, self._R = np.array([0.5]), np.array([[0.01]])

    def steps(self, count: int) -> None:
        """Predict to the wheel speed, take it in, predict to the pose, its altitude too."""
        for _ in range(count):
            self._filter.predict()
            self._filter.update(self._z, self._R, self._H)
            self._filter.predict()
            self._altitude.predict()
