"""Pure: measurements of one instant, each judged by what the filter and all others say of it.

With S the covariance of the innovations y, the i-th lies (S^-1 y)_i / (S^-1)_ii from what all
others say, with a variance of 1 / (S^-1)_ii (data snooping; W. Baarda, A testing procedure for use
in geodetic networks, 1968).
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wayline.likelihood import Floats


class Judged(NamedTuple):
    """Measurements of one epoch held against the filter and each other."""

    is_accepted: NDArray[np.bool_]
    off: Floats
    """From what the filter and the others that are accepted say, in stds of that."""

    def refused_share(self, among: NDArray[np.bool_]) -> float:
        """Of some of them."""
        return 1.0 - float(np.mean(self.is_accepted[among])) if among.any() else 0.0


def judged(y: Floats, covariance: Floats, limit: float) -> Judged:
    """Refuse the most unlikely one as long as one is over the limit (of the squared `off`)."""
    inverse = np.linalg.inv(covariance)
    is_accepted = np.ones(len(y), dtype=bool)
    off = np.zeros(len(y))
    while is_accepted.any():
        kept = np.flatnonzero(is_accepted)
        off[kept] = (inverse[np.ix_(kept, kept)] @ y[kept]) / np.sqrt(inverse[kept, kept])
        worst = kept[int(np.argmax(np.abs(off[kept])))]
        if off[worst] ** 2 <= limit:
            break
        is_accepted[worst] = False
        # without it the inverse is that of the covariance without its row and column
        inverse = inverse - np.outer(inverse[worst], inverse[worst]) / inverse[worst, worst]
    return Judged(is_accepted, off)
