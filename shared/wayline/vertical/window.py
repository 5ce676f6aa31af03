"""Pure: what is read of wheels and engine in half a second, and the mean force between two such."""

from bisect import bisect_left
from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple


class Force(NamedTuple):
    """What one torque says."""

    t_ns: int
    force_n: float
    turns_per_m2: float
    """Radians of the engine for a metre of way, squared."""


@dataclass
class Block:
    """Readings after one instant and up to another."""

    begin_ns: int
    times_ns: list[int] = field(default_factory=list)
    speeds_mps: list[float] = field(default_factory=list)
    forces: list[Force] = field(default_factory=list)
    is_braked: bool = False

    def read(self, t_ns: int, speed_mps: float) -> None:
        """Take a reading of the wheels."""
        self.times_ns.append(t_ns)
        self.speeds_mps.append(speed_mps)

    @property
    def end_ns(self) -> int:
        """Of the last reading of the wheels."""
        return self.times_ns[-1]

    @cached_property
    def middle_ns(self) -> int:
        """Mean of the readings' instants; asked when none is to come."""
        return sum(self.times_ns) // len(self.times_ns)

    @cached_property
    def speed_mps(self) -> float:
        """Mean of the readings; asked when none is to come."""
        return sum(self.speeds_mps) / len(self.speeds_mps)

    @cached_property
    def force_n(self) -> float:
        """Mean of the forces; asked when none is to come."""
        return sum(force.force_n for force in self.forces) / len(self.forces)

    def share_before(self, t_ns: int) -> float:
        """Share of the readings of the wheels before an instant."""
        return bisect_left(self.times_ns, t_ns) / len(self.times_ns)


def weighted_force(before: Block, after: Block) -> tuple[float, float, float]:
    """Mean force, mean square of the engine's turns, and of how many samples they are made.

    The mean speeds of two blocks differ by the accelerations between their readings; one at an
    instant counts as often as readings of the first lie before and of the second behind it.
    """
    total = force_n = turns_per_m2 = 0.0
    for force in (*before.forces, *after.forces):
        weight = before.share_before(force.t_ns) - after.share_before(force.t_ns)
        total += weight
        force_n += weight * force.force_n
        turns_per_m2 += weight * force.turns_per_m2
    if total <= 0.0:
        # a single torque beside the readings; it is all there is
        forces = (*before.forces, *after.forces)
        return before.force_n, forces[0].turns_per_m2, 1.0
    return force_n / total, turns_per_m2 / total, total
