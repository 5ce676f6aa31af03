"""Pure: how much a sensor's claimed noise is to be scaled, learned from its innovations."""

import msgspec

PRIOR_WEIGHT = 10.0
"""The claim counts as this many measurements..."""
WEIGHT_MAX = 60.0
"""...and what was seen is forgotten over so many: a minute of a 1 Hz receiver."""
SQUARE_MAX = 9.0
"""One measurement counts as three sigma at most: outliers are the gate's business."""
FACTOR_MAX = 25.0
"""Of the variance."""


class NoiseScale(msgspec.Struct, frozen=True):
    """Factor on the claimed variance of white noise: an exponentially forgetting mean.

    Innovations have the variance H P H' + R. What remains without the first term, over the R that
    was claimed, is one sample of the factor.
    """

    factor: float = 1.0
    weight: float = PRIOR_WEIGHT

    def learned(
        self, square: float, predicted: float, claimed: float, least: float
    ) -> "NoiseScale":
        """With one more squared innovation and the two parts of its expected variance.

        The factor does not fall below `least`.
        """
        bounded = min(square, SQUARE_MAX * (predicted + self.factor * claimed))
        sample = (bounded - predicted) / claimed
        weight = min(self.weight + 1.0, WEIGHT_MAX)
        factor = self.factor + (sample - self.factor) / weight
        return NoiseScale(min(max(factor, least), FACTOR_MAX), weight)
