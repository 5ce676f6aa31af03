"""Pure: the backward pass over a run that was filtered forward (Rauch, Tung and Striebel, 1965)."""

import numpy as np

from wayline.likelihood import Floats


def rts(x: Floats, P: Floats, F: Floats, Q: Floats) -> tuple[Floats, Floats]:
    """Means (n, size) and covariances (n, size, size) given all that was measured.

    `x` and `P` are those after each of n corrections, `F[k]` and `Q[k]` what led to the k-th. The
    gains of all steps are one batch, because each by itself is mostly the calls around it.
    """
    x, P = x.copy(), P.copy()
    ahead = F[1:].transpose(0, 2, 1)
    predicted = F[1:] @ P[:-1] @ ahead + Q[1:]
    gains = P[:-1] @ ahead @ np.linalg.inv(predicted)
    predicted_x = np.einsum("kij,kj->ki", F[1:], x[:-1])
    for k in range(len(x) - 2, -1, -1):
        gain = gains[k]
        x[k] += gain.dot(x[k + 1] - predicted_x[k])
        P[k] += gain.dot(P[k + 1] - predicted[k]).dot(gain.T)
    return x, P
