"""Pure: how much a sensor's claimed noise is to be scaled, learned from its innovations."""

import msgspec

PRIOR_WEIGHT = 10.0
"""The claim counts as this many measurements."""
WEIGHT_MAX = 60.0
"""Measurements are forgotten over so many: half a minute to a minute of a 1 Hz receiver."""
SQUARE_MAX = 9.0
"""One measurement counts as three sigma at most, rejected ones too: a receiver that is noisier than
the gate allows for would else never be found out."""
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

        The less of the expected variance is the sensor's, the less does it say of the sensor. The
        factor does not fall below `least`.
        """
        expected = self.factor * claimed
        bounded = min(square, SQUARE_MAX * (predicted + expected))
        sample = (bounded - predicted) / claimed
        share = expected / (expected + predicted)
        weight = min(self.weight + share, WEIGHT_MAX)
        factor = self.factor + (sample - self.factor) * share / weight
        return NoiseScale(min(max(factor, least), FACTOR_MAX), weight)
