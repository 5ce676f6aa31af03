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
        total = np.count_nonzero(among)
        accepted = np.count_nonzero(self.is_accepted & among)
        return 1.0 - accepted / total if total else 0.0


def judged(y: Floats, covariance: Floats, limit: float) -> Judged:
    """Refuse the most unlikely one as long as one is over the limit (of the squared `off`)."""
    inverse = np.linalg.inv(covariance)
    off = inverse.dot(y) / np.sqrt(inverse.diagonal())
    is_accepted = np.ones(len(y), dtype=np.bool_)
    kept = np.arange(len(y))
    while len(kept):
        worst = int(np.abs(off[kept]).argmax())
        if off[kept[worst]] ** 2 <= limit:
            break
        # without it the inverse is that of the covariance without its row and column
        inverse = inverse - np.outer(inverse[worst], inverse[worst]) / inverse[worst, worst]
        inverse = np.delete(np.delete(inverse, worst, axis=0), worst, axis=1)
        is_accepted[kept[worst]] = False
        kept = np.delete(kept, worst)
        off[kept] = inverse.dot(y[kept]) / np.sqrt(inverse.diagonal())
    return Judged(is_accepted, off)
