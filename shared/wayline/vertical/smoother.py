"""Pure: the backward pass over a run that was filtered forward (Rauch, Tung and Striebel, 1965)."""

import numpy as np

from wayline.likelihood import Floats


def rts(x: Floats, P: Floats, F: Floats, Q: Floats) -> tuple[Floats, Floats]:
    """Means (n, size) and covariances (n, size, size) given all that was measured.

    `x` and `P` are those after each of n corrections, `F[k]` and `Q[k]` what led to the k-th. What
    a step knows by itself is one batch, because each by itself is mostly the calls around it; only
    what it learns of the one behind it is left for the loop.
    """
    moved_x, moved_P = np.einsum("kij,kj->ki", F[1:], x[:-1]), F[1:] @ P[:-1]
    predicted = moved_P @ F[1:].transpose(0, 2, 1) + Q[1:]
    back = np.linalg.solve(predicted, moved_P)
    gains = np.ascontiguousarray(back.transpose(0, 2, 1))
    x, P = x.copy(), P.copy()
    x[:-1] -= np.einsum("kij,kj->ki", gains, moved_x)
    P[:-1] -= gains @ moved_P
    means, covariances = list(x), list(P)
    mean, covariance = means.pop(), covariances.pop()
    for gain, turned in zip(reversed(list(gains)), reversed(list(back)), strict=True):
        behind, behind_covariance = mean, covariance
        mean, covariance = means.pop(), covariances.pop()
        mean += gain.dot(behind)
        covariance += gain.dot(behind_covariance).dot(turned)
    return x, P
