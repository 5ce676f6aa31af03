"""Pure: the roads that are known, and where they run; one for all vehicles of a process."""

from collections.abc import Iterable, Sequence

from wayline.line import Line
from wayline.matching.network import Candidate, First, Sight
from wayline_slope_map.matching import RoadIndex
from wayline_slope_map.profile import RoadProfile
from wayline_slope_map.roads import Road, check_same_route, route_road


class KnownRoads:
    """Profiles of roads by id, and an index of their lines. What one vehicle taught, all know."""

    def __init__(
        self, profiles: Iterable[RoadProfile] = (), index: RoadIndex | None = None
    ) -> None:
        self._profiles: dict[str, RoadProfile] = {}
        self._index = index or RoadIndex()
        self._route_ids: list[str] = []
        """Of the routes that vehicles follow."""
        for profile in profiles:
            self.learn(profile)

    def follow(self, route: Line, route_id: str, *, loop: bool, bin_m: float) -> None:
        """Let a route's line be the road of the vehicles that follow it.

        Raises InputError if the line is not the one that is known by the route's id.
        """
        road = route_road(route, route_id, loop=loop, bin_m=bin_m)
        if route_id in self._profiles:
            check_same_route(self._profiles[route_id].road, road)
        else:
            self.learn(RoadProfile(road, {}))
        self._route_ids.append(route_id)

    def learn(self, profile: RoadProfile) -> None:
        """Take a road as it is known from now on.

        Raises InputError if it is a route's and its line another: the database was away when
        the route was first followed.
        """
        road_id = profile.road.road_id
        if road_id in self._route_ids:
            check_same_route(profile.road, self._profiles[road_id].road)
        self._profiles[road_id] = profile
        self._index.add(profile.road)

    def profile(self, road_id: str) -> RoadProfile:
        """A road that is known."""
        return self._profiles[road_id]

    def roads(self) -> dict[str, Road]:
        """Every road by its id."""
        return {road_id: profile.road for road_id, profile in self._profiles.items()}

    def near(self, sight: Sight, route_id: str | None = None) -> Sequence[Candidate]:
        """Every road point near a place of a vehicle, which may follow a route.

        Its route goes before other roads; the routes of others are no roads of its own.
        """
        own_id = route_id or (self._route_ids[0] if len(self._route_ids) == 1 else None)
        found = self._index.near(sight)
        others = {each for each in self._route_ids if each != own_id}
        own = [each for each in found if each.edge_id == own_id]
        return own or [each for each in found if each.edge_id not in others]

    def first(self, candidates: Sequence[Candidate]) -> Sequence[First]:
        """Where they are; nothing speaks against any."""
        return self._index.first(candidates)

    def advance_m(self, earlier: Candidate, later: Candidate, about_m: float) -> float | None:
        """Along one road in one direction; None where that is not one road."""
        return self._index.advance_m(earlier, later, about_m)


class RoadsOfVehicle:
    """The known roads as the network of one vehicle, of which it may be known what it follows."""

    def __init__(self, roads: KnownRoads, route_id: str | None = None) -> None:
        self._roads, self._assigned_id = roads, route_id
        self._followed_id = route_id

    def follow(self, route_id: str | None) -> None:
        """Take what the vehicle is seen to follow, unless that was assigned."""
        self._followed_id = self._assigned_id or route_id

    def near(self, sight: Sight) -> Sequence[Candidate]:
        """Every road point near a place that the vehicle may be on."""
        return self._roads.near(sight, self._followed_id)

    def first(self, candidates: Sequence[Candidate]) -> Sequence[First]:
        """Where they are; nothing speaks against any."""
        return self._roads.first(candidates)

    def advance_m(self, earlier: Candidate, later: Candidate, about_m: float) -> float | None:
        """Along one road in one direction; None where that is not one road."""
        return self._roads.advance_m(earlier, later, about_m)
