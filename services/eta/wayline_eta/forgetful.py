"""Pure: a mean and a variance that forget."""

import msgspec

RUNS = 20.0
"""What is older than so many observations counts for little."""


class Forgetful(msgspec.Struct, frozen=True):
    """Of a quantity that changes slowly: each observation counts for less as others follow."""

    weight: float = 0.0
    mean: float = 0.0
    square: float = 0.0
    """The weighted sum of squares about the mean."""

    def with_value(self, value: float) -> "Forgetful":
        """After one more observation (West 1979, with decay)."""
        kept = self.weight * (1.0 - 1.0 / RUNS)
        weight = kept + 1.0
        off = value - self.mean
        mean = self.mean + off / weight
        square = self.square * (1.0 - 1.0 / RUNS) + kept * off * off / weight
        return Forgetful(weight, mean, square)

    def blended(self, mean: float, weight: float) -> float:
        """The mean, beside another that is worth so many observations."""
        return (self.weight * self.mean + weight * mean) / (self.weight + weight)

    def variance(self, prior: float, weight: float) -> float:
        """Of one observation; `prior` is worth so many of them."""
        return (self.square + weight * prior) / (self.weight + weight)
