"""A few straight streets of known place, as a network for the tests of the matcher."""

from collections.abc import Mapping, Sequence

from unit.eta.route_drives import SECOND_NS, START_NS, TOWN, Metres, line_of
from wayline.matching.candidates import locally_nearest
from wayline.matching.network import Candidate, First, Sight


class Streets:
    """Lines by their ids; `joins` says which street another's end leads into."""

    def __init__(
        self, lines: Mapping[str, Sequence[Metres]], joins: Mapping[str, Sequence[str]]
    ) -> None:
        self._lines = {edge_id: line_of(points_m) for edge_id, points_m in lines.items()}
        self._joins = joins

    def near(self, sight: Sight) -> list[Candidate]:
        return [
            Candidate(edge_id, 1, *near)
            for edge_id, line in self._lines.items()
            for near in locally_nearest(line, sight.lat_deg, sight.lon_deg)
            if abs(near.offset_m) < 100.0
        ]

    def first(self, candidates: Sequence[Candidate]) -> list[First]:
        return [First(candidate.along_m) for candidate in candidates]

    def advance_m(self, earlier: Candidate, later: Candidate, about_m: float) -> float | None:
        del about_m
        if earlier.edge_id == later.edge_id:
            return later.along_m - earlier.along_m
        if later.edge_id in self._joins.get(earlier.edge_id, ()):
            return self._lines[earlier.edge_id].length_m - earlier.along_m + later.along_m
        return None


def sight(
    second: float, at_m: Metres, course_deg: float | None = None, *, stands: bool = False
) -> Sight:
    """Seen so many seconds after the start, so far east and north."""
    t_ns = START_NS + round(second * SECOND_NS)
    return Sight(t_ns, *TOWN.to_geodetic(*at_m), 4.0, course_deg, stands=stands)
