"""Pure: the algebra of an extended Kalman filter, as Welch and Bishop (TR 95-041) write it."""

import numpy as np
from scipy.stats import chi2

from wayline_evaluation.estimates import Floats


class Gaussian:
    """A state's mean (n,) and covariance (n, n)."""

    def __init__(self, mean: Floats, stds: Floats) -> None:
        self.mean = mean
        self.covariance = np.diag(np.square(stds))

    def copy(self) -> "Gaussian":
        """One that goes its own way; arrays are never changed in place but by `set`."""
        other = Gaussian(self.mean.copy(), np.zeros(len(self.mean)))
        other.covariance = self.covariance.copy()
        return other

    def advance(self, mean: Floats, transition: Floats, noise: Floats) -> None:
        """To a predicted mean; `noise` is the process noise's covariance, (n, n)."""
        self.mean = mean
        self.covariance = transition @ self.covariance @ transition.T + noise

    def correct(
        self, innovation: Floats, sensitivity: Floats, noise: Floats, gate: float | None = None
    ) -> bool:
        """Take in a measurement of (m,); False where its normalised innovation is past the gate.

        `sensitivity` is (m, n), `noise` the measurement's covariance (m, m).
        """
        spread = self.covariance @ sensitivity.T
        expected = sensitivity @ spread + noise
        gain = np.linalg.solve(expected, spread.T).T
        if gate is not None and innovation @ np.linalg.solve(expected, innovation) > gate:
            return False
        self.mean = self.mean + gain @ innovation
        # Joseph's form stays positive where a tiny noise meets a large covariance
        kept = np.eye(len(self.mean)) - gain @ sensitivity
        covariance = kept @ self.covariance @ kept.T + gain @ noise @ gain.T
        self.covariance = 0.5 * (covariance + covariance.T)
        return True

    def set(self, place: int, value: float, std: float) -> None:
        """Forget what was known of one part of the state."""
        self.mean[place] = value
        self.covariance[place, :] = self.covariance[:, place] = 0.0
        self.covariance[place, place] = std * std


def gate_of(probability: float, dimensions: int) -> float:
    """Bound of the normalised innovation squared that good measurements pass so often."""
    return float(chi2.ppf(probability, dimensions))


def decayed(stds: Floats, times_s: Floats, step_s: float) -> tuple[Floats, Floats]:
    """Of Gauss-Markov processes over a step: the share that is kept, and the new variance."""
    kept = np.exp(-step_s / times_s)
    return kept, np.square(stds) * (1.0 - np.square(kept))
