"""Pure: how much slower than usual a leg is now: a scalar Kalman filter, fed by who drove it last.

The state is the logarithm of taken over usual time. It is Gauss-Markov about nothing: it fades
within CONGESTION_S, and nobody knows better than CONGESTION_STD what he has not seen.
"""

import math
from typing import NamedTuple

import numpy as np
from filterpy.kalman import predict, update

CONGESTION_STD = 0.10
CONGESTION_S = 1_200.0


class Congestion(NamedTuple):
    """Of one leg, of all vehicles over it."""

    t_ns: int = 0
    mean: float = 0.0
    variance: float = CONGESTION_STD**2

    def at(self, t_ns: int) -> "Congestion":
        """Later: it fades, and nobody knows better than before."""
        F = math.exp(-max(t_ns - self.t_ns, 0) * 1e-9 / CONGESTION_S)
        x, P = predict(self.mean, self.variance, F=F, Q=(1.0 - F**2) * CONGESTION_STD**2)
        return Congestion(max(t_ns, self.t_ns), float(x), float(P))

    def measured(self, off: float, variance: float) -> "Congestion":
        """After a run that was off from what is usual."""
        x, P = np.array([self.mean]), np.array([[self.variance]])
        x, P = update(x, P, np.array([off]), np.array([[variance]]), H=np.eye(1))
        return Congestion(self.t_ns, x.item(), P.item())
