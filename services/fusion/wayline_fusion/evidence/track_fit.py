"""Pure: the fixes of the last minute laid over the way that gyro and wheels have reckoned.

Both are the same curve, shifted and turned. What is left between them when they lie as near to
each other as they can (least squares of a rigid motion; Umeyama 1991, without the scale) is the
noise of the fixes, whatever they claim; the turn tells the heading. A bias of the gyro bends the
reckoned way, so it is fitted too, as far as it is not known.
"""

import cmath
import math
from typing import NamedTuple

import msgspec
import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

APART_M = 3.0
APART_NS = 1_000_000_000
"""Fixes that are nearer to the last one, in way and time, tell nothing new."""
SPAN_NS = 90_000_000_000
"""Older fixes are forgotten: a gyro's bias bends a longer way."""
SEEN_MAX = 90
FITTED_MIN = 5
PLACED_TOLD = 2.0
"""Independent fixes in a mean that forgets over the time for which they are wrong alike."""
FITTED = 3.0
"""Numbers that a fit takes: a shift and a turn."""
FREE_SHARE_MIN = 0.25
CORRELATED_S = 30.0
"""Fixes are wrong alike for about so long; so many of them tell as much as one."""


class Seen(NamedTuple):
    """A fix, and where reckoning was: east + i north, in metres."""

    t_ns: int
    fix_m: complex
    reckoned_m: complex
    biased_s: float
    """For how long the gyro's bias has turned the reckoned way."""


class Fit(NamedTuple):
    """How the reckoned way lies on the map."""

    noise_m: float
    """Std per axis of the fixes about the way."""
    turn_rad: float
    """From headings as reckoned now to true ones, clockwise."""
    place_m: complex
    """Of the vehicle now."""
    bias_radps: float
    """Of the gyro, clockwise."""
    covariance: Floats
    """Of east, north, heading and bias."""
    seen: int
    told: float
    """Fixes of those that are wrong each in its own way."""

    @property
    def turn_std_rad(self) -> float:
        """Of the heading."""
        return math.sqrt(float(self.covariance[2, 2]))


class Track(msgspec.Struct, frozen=True):
    """Of one vehicle; its plane is the one in which the fixes are given."""

    seen: tuple[Seen, ...] = ()

    def with_fix(self, seen: Seen) -> "Track":
        """With a fix that is far enough from the last one."""
        if self.seen:
            last = self.seen[-1]
            is_near = abs(seen.reckoned_m - last.reckoned_m) < APART_M
            if is_near or seen.t_ns - last.t_ns < APART_NS:
                return self
        oldest_ns = seen.t_ns - SPAN_NS
        kept = tuple(each for each in self.seen if each.t_ns >= oldest_ns)
        return Track((*kept, seen)[-SEEN_MAX:])

    def fit(
        self, now: Seen, claimed_m: float, bias_radps: float, bias_std_radps: float
    ) -> Fit | None:
        """The rigid motion, with the vehicle `now`; None of too few.

        The noise counts as `claimed_m` at least. The bias, clockwise, and its std are what is known
        of the gyro now.
        """
        if len(self.seen) < FITTED_MIN:
            return None
        times_s = np.array([(each.t_ns - now.t_ns) * 1e-9 for each in self.seen])
        fixes = np.array([each.fix_m for each in self.seen])
        to_here = self._unbent(now, bias_radps)
        way, here_m = to_here[:-1], to_here[-1]
        middle_s, fix_m, way_m = times_s.mean(), fixes.mean(), way.mean()
        fixes, way, here_m = fixes - fix_m, way - way_m, here_m - way_m
        spread_m2 = float(np.mean(np.abs(way) ** 2))
        if spread_m2 < APART_M**2:
            return None
        turned = complex(np.vdot(way, fixes))
        turned /= abs(turned)
        # what a turn and a turn per second would move each fix by
        steps = np.diff(way, prepend=way[:1])
        bent = np.cumsum((times_s - middle_s) * steps)
        moves = 1j * turned * np.column_stack((way, bent - bent.mean()))
        left = fixes - turned * way
        told = max(-float(times_s[0]) / CORRELATED_S, 1.0)
        bends = Bends(moves, left, len(left) / told, bias_std_radps)
        noise_m = bends.noise_m(bends.solved(claimed_m).solution)
        solved = bends.solved(max(noise_m, claimed_m))
        angle_rad, rate_radps = solved.solution
        turned *= cmath.exp(1j * angle_rad)
        noise_m = bends.noise_m(solved.solution)
        # complex angles are counter-clockwise from east, headings clockwise from north
        by_fitted = np.array(
            [
                [1.0, 0.0, *moves[-1].real],
                [0.0, 1.0, *moves[-1].imag],
                [0.0, 0.0, -1.0, middle_s],
                [0.0, 0.0, 0.0, 1.0],
            ]
        )
        # reckoning drifts, and fixes become wrong anew: the newest tell best where the way ends
        weights = np.exp((times_s - times_s[-1]) / CORRELATED_S)
        astray_m = complex(np.average(left - moves @ solved.solution, weights=weights))
        placed = min(told, PLACED_TOLD)
        fitted = np.zeros((4, 4))
        fitted[:2, :2] = max(noise_m, claimed_m) ** 2 / placed * np.eye(2)
        fitted[2:, 2:] = solved.covariance
        return Fit(
            noise_m,
            -cmath.phase(turned) + rate_radps * middle_s,
            complex(fix_m + turned * here_m + moves[-1, 1] * rate_radps + astray_m),
            bias_radps + rate_radps,
            by_fitted @ fitted @ by_fitted.T,
            len(left),
            told,
        )

    def _unbent(self, now: Seen, bias_radps: float) -> NDArray[np.complex128]:
        """The reckoned way without the gyro's bias, to where it has come now."""
        seen = (*self.seen, now)
        way = np.array([each.reckoned_m for each in seen])
        biased_s = np.array([each.biased_s for each in seen])
        middles_s = 0.5 * (biased_s[1:] + biased_s[:-1]) - biased_s[-1]
        # headings are clockwise, complex angles are not: a bias taken off turns it the other way
        steps = np.diff(way) * np.exp(1j * bias_radps * middles_s)
        return np.concatenate(([0.0], np.cumsum(steps)))


class Solved(NamedTuple):
    """Turn and turn per second, counter-clockwise, with their covariance."""

    solution: Floats
    covariance: Floats


class Bends(NamedTuple):
    """What is left between fixes and way, and what turns of the way would make of it."""

    moves: NDArray[np.complex128]
    """A column for a turn, one for a turn per second."""
    left: NDArray[np.complex128]
    alike: float
    """So many fixes tell as much as one."""
    bias_std_radps: float

    def solved(self, noise_m: float) -> Solved:
        """Least squares; the turn per second is held by what is known of the gyro's bias."""
        weight = 1.0 / (noise_m**2 * self.alike)
        normal = weight * (self.moves.conj().T @ self.moves).real
        normal[1, 1] += 1.0 / self.bias_std_radps**2
        covariance = np.asarray(np.linalg.inv(normal), dtype=np.float64)
        return Solved(covariance @ (weight * (self.moves.conj().T @ self.left).real), covariance)

    def noise_m(self, solution: Floats) -> float:
        """Std per axis of what is left."""
        left = self.left - self.moves @ solution
        # a fit takes a share of the noise with it, of few independent fixes most
        independent = 2.0 * len(left) / self.alike
        free = max(independent - FITTED, FREE_SHARE_MIN * independent)
        return math.sqrt(0.5 * float(np.mean(np.abs(left) ** 2)) * independent / free)
