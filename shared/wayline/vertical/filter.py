"""Pure: the forward filter of altitude and slope; filterpy does the Kalman algebra.

What changes the covariance besides prediction and update is named `project_` where time would do
it too, and `inflate_` where it adds doubt.
"""

import math

import numpy as np
from filterpy.kalman import KalmanFilter

from wayline.likelihood import Floats, Measurement
from wayline.tuning import Tuning
from wayline.vertical.model import Transition, VerticalModel
from wayline.vertical.states import VerticalStates

S = VerticalStates
LEAST_INVERSE = 0.01
"""A mass is positive, whatever a torque of the wrong sign says."""
SAME_ERROR_RATIO = 0.7
"""Of two claimed stds of a receiver; a satellite more or less changes them by less."""


class VerticalFilter(KalmanFilter):  # type: ignore[misc]
    """Kalman filter over `VerticalStates`; receivers are counted from 0."""

    def __init__(self, tuning: Tuning, receivers: int = 1) -> None:
        self._tuning = tuning
        self._resize(receivers)
        self.x, self.P = self.model.first()

    def _resize(self, receivers: int) -> None:
        self.model = VerticalModel(self._tuning, receivers)
        super().__init__(dim_x=self.model.size, dim_z=1)
        self._moved = self.model.transition(0.0, 0.0)
        self.F, self.Q = self._moved

    def add_receiver(self) -> None:
        """Make room for the slow error of one more."""
        x, P = np.append(self.x, 0.0), np.pad(self.P, (0, 1))
        P[-1, -1] = 1.0
        self.set(x, P)

    def set(self, x: Floats, P: Floats) -> None:
        """Set the state, which may be one of another number of receivers."""
        if len(x) != self.model.size:
            self._resize(len(x) - S.GPS_ERROR)
        self.x, self.P = x, P

    def advance(self, distance_m: float, elapsed_s: float) -> Transition:
        """Predict over a distance driven forward (negative in reverse) and the time it took.

        The next step is written over what is returned.
        """
        moved = self.model.moved(self._moved, distance_m, elapsed_s)
        self.predict()
        return moved

    def step(self, moved: Transition) -> None:
        """Predict over a step, without what filterpy keeps of it."""
        F, Q = moved
        self.x = F.dot(self.x)
        P = F.dot(self.P).dot(F.T)
        P += Q
        self.P = P

    def project_error(self, receiver: int, before_m: float, std_m: float) -> Transition | None:
        """Renew a receiver's slow error where its std is another one; None where it is not.

        Other satellites, or a receiver that has settled, make another error.
        """
        kept = min(before_m, std_m) / max(before_m, std_m)
        if kept >= SAME_ERROR_RATIO:
            return None
        transition = self.model.renewal(receiver, kept)
        self.predict(F=transition.F, Q=transition.Q)
        return transition

    def project_window(self, std_mps: float, *, goes_on: bool) -> Transition:
        """Let a window of torque begin: the error of the wheels at its end is a new one."""
        transition = self.model.handover(std_mps, goes_on=goes_on)
        self.predict(F=transition.F, Q=transition.Q)
        return transition

    def inflate_altitude(self, std_m: float) -> Floats:
        """Doubt the altitude, and the barometer's bias by as much the other way.

        Their sum is what the barometer measures, and stays. Returns what P gains.
        """
        doubted = np.zeros(len(self.x))
        doubted[S.ALTITUDE], doubted[S.BARO_BIAS] = std_m, -std_m
        gained: Floats = np.outer(doubted, doubted)
        self.P = self.P + gained
        return gained

    def inflate_bias(self, std_m: float) -> Floats:
        """Doubt the barometer's bias alone. Returns what P gains."""
        gained: Floats = np.zeros_like(self.P)
        gained[S.BARO_BIAS, S.BARO_BIAS] = std_m**2
        self.P = self.P + gained
        return gained

    def inflate_mass(self, std_share: float) -> Floats:
        """Doubt the mass. Returns what P gains."""
        gained: Floats = np.zeros_like(self.P)
        gained[S.INVERSE_MASS, S.INVERSE_MASS] = std_share**2
        self.P = self.P + gained
        return gained

    def inflate_slope(self, std: float) -> Floats:
        """Doubt the slope, a tangent. Returns what P gains."""
        gained: Floats = np.zeros_like(self.P)
        gained[S.SLOPE, S.SLOPE] = std**2
        self.P = self.P + gained
        return gained

    @property
    def mass(self) -> float:
        """True mass over the stated one."""
        return 1.0 / max(self.x.item(S.INVERSE_MASS), LEAST_INVERSE)

    @property
    def mass_std(self) -> float:
        """One sigma of the mass, as a share of the stated one."""
        return self.std(S.INVERSE_MASS) * self.mass**2

    def expected(self, measurement: Measurement) -> Floats:
        """Covariance of the innovation without the measurement's own noise, H P H'."""
        H = measurement.H
        predicted: Floats = H.dot(self.P).dot(H.T)
        return predicted

    def correct(self, measurement: Measurement) -> None:
        """Update the state with a measurement of one number that was made of it.

        As filterpy's update without its Joseph form and what it keeps of each step: a run is
        corrected some ten thousand times.
        """
        H = measurement.H[0]
        PH = self.P.dot(H)
        std = math.sqrt(H.dot(PH) + measurement.R[0, 0])
        root = PH / std
        self.x = self.x + root * (measurement.y[0] / std)
        lost = root[:, np.newaxis] * root
        self.P = np.subtract(self.P, lost, out=lost)

    def std(self, state: int) -> float:
        """One sigma of a state, in the state's own unit."""
        variance: float = self.P.item(state, state)
        return 0.0 if variance < 0.0 else math.sqrt(variance)
