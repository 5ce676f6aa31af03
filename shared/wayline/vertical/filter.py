"""Pure: the forward filter of altitude and slope; filterpy does the Kalman algebra.

What changes the covariance besides prediction and update is `project_`, as time would, or
`inflate_`, which adds doubt.
"""

import math

import numpy as np
from filterpy.kalman import KalmanFilter

from wayline.likelihood import Floats, Measurement
from wayline.tuning import Tuning
from wayline.vertical.model import Transition, VerticalModel, VerticalStates

S = VerticalStates


class VerticalFilter(KalmanFilter):  # type: ignore[misc]
    """Kalman filter over `VerticalStates`; receivers are counted from 0."""

    def __init__(self, tuning: Tuning, receivers: int = 1) -> None:
        self._tuning = tuning
        self._resize(receivers)
        self.x, self.P = self.model.first()
        self.slow_stds_m: tuple[float, ...] = (0.0,) * receivers
        """Of the slow error of each receiver's altitude."""

    def _resize(self, receivers: int) -> None:
        self.model = VerticalModel(self._tuning, receivers)
        super().__init__(dim_x=self.model.size, dim_z=1)
        self.inv = _inverse

    def add_receiver(self) -> None:
        """Make room for one more; of its error nothing is known before its first altitude."""
        x, P, slow_stds_m = self.x, self.P, self.slow_stds_m
        self._resize(len(slow_stds_m) + 1)
        self.set(np.append(x, 0.0), np.pad(P, (0, 1)), (*slow_stds_m, 0.0))

    def set(self, x: Floats, P: Floats, slow_stds_m: tuple[float, ...]) -> None:
        """Set the state, which may be of another number of receivers."""
        if len(slow_stds_m) != self.model.size - S.GPS_ERROR:
            self._resize(len(slow_stds_m))
        self.x, self.P, self.slow_stds_m = x, P, slow_stds_m

    def advance(self, distance_m: float, elapsed_s: float) -> Transition:
        """Predict over a distance driven forward (negative in reverse) and the time it took."""
        transition = self.model.transition(distance_m, elapsed_s, self.slow_stds_m)
        self.predict(F=transition.F, Q=transition.Q)
        return transition

    def project_error(self, receiver: int, std_m: float) -> Transition:
        """Let a receiver's slow error tend to the slow part of `std_m` from now on."""
        slow_m, _ = self.model.shares_m(std_m)
        transition = self.model.renewal(receiver, self.slow_stds_m[receiver], slow_m)
        self.predict(F=transition.F, Q=transition.Q)
        before = self.slow_stds_m
        self.slow_stds_m = (*before[:receiver], slow_m, *before[receiver + 1 :])
        return transition

    def inflate_altitude(self, std_m: float) -> Floats:
        """Doubt the altitude, and the barometer's bias by as much the other way.

        Their sum is what the barometer measures, and stays. Returns what P gains.
        """
        doubted = np.zeros(len(self.x))
        doubted[S.ALTITUDE], doubted[S.BARO_BIAS] = std_m, -std_m
        gained = np.outer(doubted, doubted)
        self.P = self.P + gained
        return gained

    def inflate_bias(self, std_m: float) -> Floats:
        """Doubt the barometer's bias alone. Returns what P gains."""
        gained = np.zeros_like(self.P)
        gained[S.BARO_BIAS, S.BARO_BIAS] = std_m**2
        self.P = self.P + gained
        return gained

    def gps_altitude(self, receiver: int, alt_m: float, std_m: float) -> Measurement:
        """A receiver's altitude: the altitude plus its slow error, plus white noise."""
        _, white_m = self.model.shares_m(std_m)
        return self._measured("gps_altitude", alt_m, S.GPS_ERROR + receiver, white_m)

    def barometer(self, alt_m: float, std_m: float) -> Measurement:
        """Barometric altitude: the altitude plus the bias of weather and sensor."""
        return self._measured("barometer", alt_m, S.BARO_BIAS, std_m)

    def _measured(self, sensor: str, alt_m: float, error: int, std_m: float) -> Measurement:
        y, H, R = np.empty(1), np.zeros((1, len(self.x))), np.empty((1, 1))
        H[0, S.ALTITUDE] = H[0, error] = 1.0
        y[0] = alt_m - self.x[S.ALTITUDE] - self.x[error]
        R[0, 0] = std_m**2
        return Measurement(sensor, y, H, R)

    def expected(self, measurement: Measurement) -> Floats:
        """Covariance of the innovation without the measurement's own noise, H P H'."""
        H = measurement.H
        predicted: Floats = H.dot(self.P).dot(H.T)
        return predicted

    def correct(self, measurement: Measurement) -> None:
        """Update the state with a measurement that was made of it."""
        H = measurement.H
        z = measurement.y + H.dot(self.x)
        self.update(float(z[0]), measurement.R, H)

    def std(self, state: int) -> float:
        """One sigma of a state, in the state's own unit."""
        variance: float = self.P.item(state, state)
        return 0.0 if variance < 0.0 else math.sqrt(variance)


def _inverse(S: Floats) -> Floats:
    """Of an innovation's covariance, a single number."""
    return 1.0 / S
