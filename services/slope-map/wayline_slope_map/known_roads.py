"""Pure: the roads that are known, and where they run; one for all vehicles of a process."""

from collections.abc import Iterable, Sequence

from wayline.line import Line
from wayline.matching.network import Candidate, First, Sight
from wayline_slope_map.matching import RoadIndex
from wayline_slope_map.profile import RoadProfile
from wayline_slope_map.roads import Road, check_same_route, route_road


class KnownRoads:
    """Profiles of roads by id, and an index of their lines. What one vehicle taught, all know."""

    def __init__(self, profiles: Iterable[RoadProfile] = ()) -> None:
        self._profiles: dict[str, RoadProfile] = {}
        self._index = RoadIndex()
        self.route_id: str | None = None
        """The route that every vehicle follows, where there is one."""
        for profile in profiles:
            self.learn(profile)

    def follow(self, route: Line, route_id: str, *, loop: bool, bin_m: float) -> None:
        """Let a route's line be the road wherever a vehicle follows it.

        Raises InputError if the line is not the one that is known by the route's id.
        """
        road = route_road(route, route_id, loop=loop, bin_m=bin_m)
        if route_id in self._profiles:
            check_same_route(self._profiles[route_id].road, road)
        else:
            self.learn(RoadProfile(road, {}))
        self.route_id = route_id

    def learn(self, profile: RoadProfile) -> None:
        """Take a road as it is known from now on.

        Raises InputError if it is the route's and its line another: the database was away when
        the route was first followed.
        """
        if profile.road.road_id == self.route_id:
            check_same_route(profile.road, self._profiles[self.route_id].road)
        self._profiles[profile.road.road_id] = profile
        self._index.add(profile.road)

    def profile(self, road_id: str) -> RoadProfile:
        """A road that is known."""
        return self._profiles[road_id]

    def roads(self) -> dict[str, Road]:
        """Every road by its id."""
        return {road_id: profile.road for road_id, profile in self._profiles.items()}

    def near(self, sight: Sight) -> Sequence[Candidate]:
        """Every road point near a place; where that route is, no other road counts."""
        found = self._index.near(sight)
        return [each for each in found if each.edge_id == self.route_id] or found

    def first(self, candidates: Sequence[Candidate]) -> Sequence[First]:
        """Where they are; nothing speaks against any."""
        return self._index.first(candidates)

    def advance_m(self, earlier: Candidate, later: Candidate, about_m: float) -> float | None:
        """Along one road in one direction; None where that is not one road."""
        return self._index.advance_m(earlier, later, about_m)
