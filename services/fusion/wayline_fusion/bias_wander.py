"""Pure: how fast this gyro's bias wanders, learned minute by minute."""

import math

import msgspec

BLOCK_S = 60.0
"""Shorter, the filter's own uncertainty hides the wander; longer, too few blocks a drive."""
PRIOR_BLOCKS = 4.0
"""The configured wander counts as so many blocks..."""
BLOCKS_MAX = 40.0
"""...and what was seen is forgotten over so many."""
LEAST, MOST = 0.5, 6.0
"""Times the configured wander: cheap gyros are four times worse than automotive ones."""


class BiasWander(msgspec.Struct, frozen=True):
    """Random walk of the bias: `factor` is the square of the configured one's multiple."""

    factor: float = 1.0
    blocks: float = PRIOR_BLOCKS
    since_ns: int | None = None
    bias_radps: float = 0.0
    std_radps: float = 0.0

    def noticed(
        self, t_ns: int, bias_radps: float, std_radps: float, walk_radps: float
    ) -> "BiasWander":
        """At an instant with the filter's bias, its std and the configured walk (per root s).

        What a block has moved the bias beyond the doubt at both its ends is wander.
        """
        if self.since_ns is None or not 0 <= t_ns - self.since_ns <= 2e9 * BLOCK_S:
            return self._from(t_ns, bias_radps, std_radps)
        elapsed_s = (t_ns - self.since_ns) * 1e-9
        if elapsed_s < BLOCK_S:
            return self
        doubt = std_radps**2 + self.std_radps**2
        moved = max((bias_radps - self.bias_radps) ** 2 - doubt, 0.0)
        blocks = min(self.blocks + 1.0, BLOCKS_MAX)
        sample = min(moved / (walk_radps**2 * elapsed_s), 4.0 * MOST**2)
        factor = self.factor + (sample - self.factor) / blocks
        factor = min(max(factor, LEAST**2), MOST**2)
        return BiasWander(factor, blocks, t_ns, bias_radps, std_radps)

    def _from(self, t_ns: int, bias_radps: float, std_radps: float) -> "BiasWander":
        return BiasWander(self.factor, self.blocks, t_ns, bias_radps, std_radps)

    @property
    def multiple(self) -> float:
        """Of the configured walk."""
        return math.sqrt(self.factor)
