"""Pure: what the matcher asks of a network of lines: a route, a trip's pattern, roads of a map."""

from collections.abc import Sequence
from typing import NamedTuple, Protocol


class Sight(NamedTuple):
    """A position where a vehicle was seen."""

    t_ns: int
    lat_deg: float
    lon_deg: float
    std_m: float
    """One sigma of the position, the mean of both axes."""
    course_deg: float | None
    """Direction of travel; None where nothing is known of it."""
    course_std_deg: float = 0.0
    stands: bool = False
    """Whether the vehicle does not move: its course then is no news."""


class Candidate(NamedTuple):
    """A place of a network where a vehicle may be."""

    edge_id: str
    direction: int
    """1 along the edge's line, -1 against it."""
    along_m: float
    """Distance along the edge's line from its start, whatever the direction."""
    offset_m: float
    """Of the vehicle from the line, positive to the right of the line's own direction."""
    heading_deg: float
    """Direction of travel of a vehicle that follows the edge there, in this direction."""


class First(NamedTuple):
    """What a network says of a vehicle that is seen for the first time."""

    total_m: float
    """How far it has come along its edge; negative where it is about to begin a lap."""
    cost: float = 0.0
    """What speaks against it, as a negative logarithm of its likelihood."""


class Network(Protocol):
    """Edges with lines. The matcher knows nothing else of them."""

    def near(self, sight: Sight) -> Sequence[Candidate]:
        """Where the vehicle may be, in any order; none where it is on no edge."""
        ...

    def first(self, candidates: Sequence[Candidate]) -> Sequence[First]:
        """Of each, where nobody has seen the vehicle before or it came by no way of the network."""
        ...

    def advance_m(self, earlier: Candidate, later: Candidate, about_m: float) -> float | None:
        """How far a vehicle drives from one place to another, negative where it backs.

        Of several ways (laps of a loop) the one nearest to `about_m`; None where there is none.
        """
        ...
