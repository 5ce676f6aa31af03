"""Pure: the lines of a timetable near a vehicle, and for how long it has followed each."""

from collections.abc import Iterator, Mapping
from types import MappingProxyType
from typing import NamedTuple

from wayline.messages import Pose
from wayline.timetable.runs import PatternPlace, Run, Runs
from wayline.tuning import Tuning
from wayline_eta.presence import MATCHES_TO_CHANGE
from wayline_eta.route_follower import RouteFollower


class Progressed(NamedTuple):
    """How far a vehicle has come, and how many fixes it has had."""

    travelled_m: float
    fixes: int
    totals_m: Mapping[PatternPlace, float] = MappingProxyType({})
    """How far along each line that was looked at."""

    def advanced_m(self, now: "Progressed", place: PatternPlace) -> float:
        """How far it has come since along a line, back counting below 0."""
        if place in self.totals_m and place in now.totals_m:
            return now.totals_m[place] - self.totals_m[place]
        return now.travelled_m - self.travelled_m


class LinesFollowed:
    """Of one vehicle: a follower for every line that is looked at."""

    def __init__(self, runs: Runs, tuning: Tuning) -> None:
        self._runs, self._tuning = runs, tuning
        self._followers: dict[PatternPlace, RouteFollower] = {}
        self._since: dict[PatternPlace, Progressed] = {}
        self._seen: tuple[Pose, float, float, bool] | None = None
        """The last that was observed."""
        self.now = self.began = Progressed(0.0, 0)
        """`began`: when what is seen now of presence on lines was first seen."""
        self._noted = self.now
        self._poses = 0
        """Since the last fix; 1 where reports are followed themselves."""
        self._by_report = False

    def __getitem__(self, place: PatternPlace) -> RouteFollower:
        if place not in self._followers:
            routes = self._runs.line_of(place)
            assert routes is not None  # noqa: S101  # a run was made of it
            self._followers[place] = RouteFollower(routes.some_route, self._tuning)
        return self._followers[place]

    def __iter__(self) -> Iterator[PatternPlace]:
        return iter(self._followers)

    def observe(
        self,
        places: set[PatternPlace],
        pose: Pose,
        lat_deg: float,
        lon_deg: float,
        *,
        reported: bool,
    ) -> None:
        """Look at these lines with the next pose, or report, and at no others."""
        self._seen = pose, lat_deg, lon_deg, reported
        for place in places:
            self[place].observe(pose, lat_deg, lon_deg, reported=reported)
        for place in [each for each in self._followers if each not in places]:
            del self._followers[place]

    def count_fix(self) -> None:
        """A receiver, or a report, has told a position."""
        self.now = self.now._replace(fixes=self.now.fixes + 1)
        self._poses = 0

    @property
    def is_settled(self) -> bool:
        """Whether the last fix has had its say in which lines are followed."""
        return self._by_report or self._poses >= MATCHES_TO_CHANGE

    def note(self, travelled_m: float, *, by_report: bool) -> None:
        """Note which lines are followed, at a pose that is sure enough to decide anything by.

        Presence changes by two sightings. Of poses that are many a fix they are of one place; of
        reports the first was a report ago.
        """
        totals_m = {place: each.total_m for place, each in self._followers.items()}
        now = Progressed(travelled_m, self.now.fixes, totals_m)
        self.began = self._noted if by_report else now
        self.now = self._noted = now
        self._by_report, self._poses = by_report, self._poses + 1
        self._since = {
            place: self._since.get(place, self.began)
            for place, follower in self._followers.items()
            if follower.on_route
        }

    def is_on(self, place: PatternPlace) -> bool:
        """Whether the vehicle followed a line at the last pose that was noted."""
        return place in self._since

    def is_followed(self, place: PatternPlace, metres: float, fixes: int) -> bool:
        """Whether the vehicle has been on a line for so far, and so many fixes have said so."""
        since, now = self._since.get(place), self.now
        return (
            since is not None
            and now.travelled_m - since.travelled_m >= metres
            and now.fixes - since.fixes >= fixes
        )

    def is_as_long(self, place: PatternPlace, other: PatternPlace) -> bool:
        """Whether a line has been followed for as long as another, or that one is not."""
        since, others = self._since.get(place), self._since.get(other)
        return others is None or (since is not None and since.travelled_m <= others.travelled_m)

    def drive(self, run: Run, *, afresh: bool) -> None:
        """Follow a run's line by that run's plan; afresh where it may have been driven before."""
        if afresh:
            self._followers[run.pattern_place] = self[run.pattern_place].again()
        self[run.pattern_place].run_as(run.trip_route.route, run.leaves_ns)
        if afresh and self._seen is not None:
            pose, lat_deg, lon_deg, reported = self._seen
            self[run.pattern_place].observe(pose, lat_deg, lon_deg, reported=reported)
