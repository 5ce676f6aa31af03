"""Pure: altitude and slope along the road (papers/004), on numpy arrays by filterpy.

The state is driven over distance, not time: z' = z + ds tan(slope) (eq. 4.11 with the horizontal
distance ds, so that grade = 100 tan(slope)). The barometer is altitude plus a wandering bias,
which eq. 4.5 leaves out.
"""

import math

import numpy as np
from filterpy.kalman import KalmanFilter

from wayline.tuning import Tuning


class States:
    """Places in the state vector, with the unit of each; plain numbers are fast to index by."""

    ALTITUDE = 0  # m above mean sea level
    SLOPE = 1  # tan of the slope angle
    BARO_BIAS = 2  # m, barometric altitude minus altitude
    GPS_ERROR = 3  # m, slowly varying error of the fixes' altitude


SIZE = 4
"""Of the state vector."""
S = States


class VerticalFilter:
    """Kalman filter over `States`; nothing is known before the first altitude."""

    def __init__(self, tuning: Tuning) -> None:
        self._tuning = tuning
        self._filter = KalmanFilter(dim_x=SIZE, dim_z=1)
        self._filter.x = np.zeros(SIZE)
        self._filter.P = np.diag(
            [
                1e6,
                (tuning.slope_initial_std_pct / 100.0) ** 2,
                tuning.baro_bias_initial_std_m**2,
                0.0,
            ]
        )
        self._filter.F = np.eye(SIZE)
        self._filter.Q = np.zeros((SIZE, SIZE))
        self._slope_walk = (tuning.slope_walk_pct_per_sqrt_m / 100.0) ** 2
        self._baro_bias_walk = tuning.baro_bias_walk_m_per_sqrt_s**2
        self._slow_std_m = 0.0
        self.known = False
        self.rejected_in_row = 0

    def advance(self, distance_m: float, dt_s: float) -> None:
        """Predict over a distance driven forward (negative in reverse) and the time it took."""
        F, Q, walk = self._filter.F, self._filter.Q, self._slope_walk
        length = abs(distance_m)
        F[S.ALTITUDE, S.SLOPE] = distance_m
        Q[S.SLOPE, S.SLOPE] = walk * length
        Q[S.ALTITUDE, S.ALTITUDE] = walk * length**3 / 3.0
        Q[S.ALTITUDE, S.SLOPE] = Q[S.SLOPE, S.ALTITUDE] = walk * length * distance_m / 2.0
        kept = math.exp(-dt_s / self._tuning.gps_error_time_s)
        F[S.GPS_ERROR, S.GPS_ERROR] = kept
        Q[S.GPS_ERROR, S.GPS_ERROR] = (1.0 - kept**2) * self._slow_std_m**2
        Q[S.BARO_BIAS, S.BARO_BIAS] = self._baro_bias_walk * dt_s
        self._filter.predict()

    def gps(self, alt_m: float, std_m: float) -> None:
        """Altitude of a fix; the first one sets the altitude, an unlikely one is left out."""
        H = np.zeros((1, SIZE))
        H[0, S.ALTITUDE] = H[0, S.GPS_ERROR] = 1.0
        slow_std_m = math.sqrt(self._tuning.gps_error_share) * std_m
        white_std_m = math.sqrt(std_m**2 - slow_std_m**2)
        self._expect_gps_error(slow_std_m)
        unlikely = self.known and self._nis(alt_m, H, white_std_m) > self._tuning.altitude_gate_nis
        if unlikely and self.rejected_in_row < self._tuning.altitude_rejections_max:
            self.rejected_in_row += 1
            return
        if unlikely:
            self._filter.P[S.ALTITUDE, S.ALTITUDE] += (alt_m - self.altitude_m) ** 2
        self.rejected_in_row = 0
        self._filter.update(np.array([alt_m]), R=white_std_m**2, H=H)
        self.known = True

    def _expect_gps_error(self, slow_std_m: float) -> None:
        """A receiver that becomes surer has lost the error it had; one that doubts may have more.

        So a cold start's error of tens of metres is not carried along for minutes.
        """
        kalman, before_m = self._filter, self._slow_std_m
        self._slow_std_m = slow_std_m
        if slow_std_m < before_m:
            shrink = slow_std_m / before_m
            kalman.x[S.GPS_ERROR] *= shrink
            kalman.P[S.GPS_ERROR, :] *= shrink
            kalman.P[:, S.GPS_ERROR] *= shrink
        else:
            kalman.P[S.GPS_ERROR, S.GPS_ERROR] += slow_std_m**2 - before_m**2

    def barometer(self, pressure_altitude_m: float, std_m: float) -> None:
        """Barometric altitude: the altitude plus the bias of weather and sensor."""
        H = np.zeros((1, SIZE))
        H[0, S.ALTITUDE] = H[0, S.BARO_BIAS] = 1.0
        self._filter.update(np.array([pressure_altitude_m]), R=std_m**2, H=H)

    @property
    def altitude_m(self) -> float:
        """Altitude above mean sea level."""
        return float(self._filter.x[S.ALTITUDE])

    @property
    def grade_pct(self) -> float:
        """Slope in the direction of travel, positive uphill."""
        return 100.0 * float(self._filter.x[S.SLOPE])

    @property
    def baro_bias_m(self) -> float:
        """Barometric altitude minus altitude."""
        return float(self._filter.x[S.BARO_BIAS])

    def std(self, state: int) -> float:
        """One sigma of a state, in the state's own unit."""
        variance: float = self._filter.P.item(state, state)
        return 0.0 if variance < 0.0 else math.sqrt(variance)

    def _nis(self, value: float, H: np.ndarray, std_m: float) -> float:
        innovation = value - float((H @ self._filter.x)[0])
        variance = float((H @ self._filter.P @ H.T)[0, 0]) + std_m**2
        return innovation**2 / variance
